// SPDX-License-Identifier: Apache-2.0
// Meshes and maps to keep away from, zones and corridors to stay in.
#include "framework/core/random.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_scene.h"
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

double drone_acceleration() {
  const Vehicle drone = camera_drone();
  return std::hypot(4.0, std::max(kGravity, drone.thrust_max() / drone.mass - kGravity));
}
double bulge(double h) {
  return drone_acceleration() * h * h / 8;
}
double asked_of(double distance, double speed, double h) {
  const double length = std::sqrt(speed * speed + 1e-4) * h + drone_acceleration() * h * h / 2;
  return std::sqrt(std::pow(distance + bulge(h), 2) + length * length / 4);
}

Eigen::VectorXd stage_of(const Vector3d& position, const Vector3d& velocity, double h) {
  Eigen::VectorXd x(7);
  x << position, velocity, h;
  return x;
}

// A mesh without a file.
class MeshOfTests final : public Shape {
 public:
  explicit MeshOfTests(std::shared_ptr<const MeshScene> scene)
      : scene_(std::move(scene)), field_(scene_, 6.0) {}
  double core_distance(const Vector3d& p, Vector3d* gradient) const override {
    return field_.distance(p, gradient);
  }
  double reach() const override { return 6; }
  bool solid() const override { return false; }
  Eigen::AlignedBox3d bounds() const override { return scene_->mesh().bounds(); }
  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override {
    return scene_->mesh();
  }
  Value record() const override { return Value::map(); }

 private:
  std::shared_ptr<const MeshScene> scene_;
  MeshDistance field_;
};

Obstacle mesh_at(const char* name, std::shared_ptr<const MeshScene> scene) {
  Obstacle obstacle = file_at(name, "mesh", "", "");
  obstacle.shape = std::make_shared<MeshOfTests>(std::move(scene));
  return obstacle;
}

Environment beside_a_house() {
  MeshBuilder builder;
  builder.box({-2, -1, 0}, {2, 3, 5});
  Environment environment;
  environment.margin = 0.5;
  const auto scene = std::make_shared<const MeshScene>(builder.take());
  environment.obstacles = {mesh_at("house", scene)};
  return environment;
}

TEST(Clearance, IsTheDistanceToTheMeshLessWhatThePathNeeds) {
  const Environment around = beside_a_house();
  const BoundRows rows("obstacle", map_of({}), around);
  EXPECT_EQ(rows.shape.row_names, (std::vector<std::string>{"house"}));
  const Obstacle house = box_at("", {-2, -1, 0}, {2, 3, 5});
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    const Vector3d p(random.uniform(-6, 6), random.uniform(-5, 7), random.uniform(-4, 9));
    const Vector3d v(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-2, 2));
    const double outside = std::min(std::abs(signed_distance(house, p)), 6.0);  // no inside
    EXPECT_NEAR(rows.values(stage_of(p, v, 0.1))(0), outside - asked_of(0.5, v.norm(), 0.1), 1e-6);
  }
  // Far away the row is constant and far from its bound.
  EXPECT_GT(rows.values(stage_of({90, 0, 0}, {9, 0, 0}, 0.1))(0), 4);
}

TEST(Clearance, DerivativesAreThoseOfTheField) {
  const Environment around = beside_a_house();
  const BoundRows rows("obstacle", map_of({}), around);
  const Vector3d v(3, -1, 0.5);
  rows.expect_derivatives(stage_of({4, 1, 2}, v, 0.1), "off a face", 0, 1e-4, 1e-4);
  rows.expect_derivatives(stage_of({4, 5, 2}, v, 0.1), "off an edge", 0, 1e-4, 1e-4);
  rows.expect_derivatives(stage_of({4, 5, 7}, v, 0.1), "off a corner", 0, 1e-4, 1e-4);
  rows.expect_derivatives(stage_of({1.3, 1, 2}, v, 0.1), "inside", 0, 1e-4, 1e-4);
  rows.expect_finite(stage_of({2, 1, 2}, v, 0.1), "on a face");
  rows.expect_finite(stage_of({2, 3, 5}, {0, 0, 0}, 0.1), "on a corner");
}

TEST(Clearance, AWallWithoutThicknessCannotBeSteppedOver) {
  MeshBuilder builder;
  builder.quad({0, -9, -9}, {0, 9, -9}, {0, 9, 9}, {0, -9, 9});
  Environment around;
  around.margin = 0.2;
  const auto scene = std::make_shared<const MeshScene>(builder.take());
  around.obstacles = {mesh_at("wall", scene)};
  const BoundRows rows("obstacle", map_of({}), around);
  // From 1 m before it to 1 m behind it within one step of 0.2 s: each stage alone is clear.
  EXPECT_LT(rows.values(stage_of({-1, 0, 0}, {10, 0, 0}, 0.2))(0), 0);
  EXPECT_GT(rows.values(stage_of({-1, 0, 0}, {0, 0, 0}, 0.2))(0), 0);
}

TEST(Clearance, AShapeThatNobodyOpenedIsAnError) {
  Environment around;
  around.obstacles = {file_at("attic", "map", "attic.ot", std::string(64, '0'))};
  expect_message([&] { BoundRows("obstacle", map_of({}), around); }, {"'attic'", "not opened"});
}

Environment in_a_yard() {
  Environment environment;
  environment.margin = 0.5;
  environment.obstacles = {
      flight_zone_at("field", {{-20, -20}, {20, -20}, {20, 20}, {-20, 20}}, 0, 30),
      flight_zone_at("yard", {{-9, -9}, {9, -9}, {9, 9}, {2, 9}, {2, 0}, {-9, 0}})};
  return with_shapes(environment);
}

TEST(FlightZone, RowsAreTheWayToTheNearestEdge) {
  const Environment around = in_a_yard();
  const BoundRows rows("obstacle", map_of({}), around);
  EXPECT_EQ(rows.shape.row_names, (std::vector<std::string>{"field", "yard"}));
  Random random(5);
  for (int k = 0; k < 500; ++k) {
    const Vector3d p(random.uniform(-25, 25), random.uniform(-25, 25), random.uniform(-4, 35));
    const Vector3d v(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-2, 2));
    const Eigen::VectorXd g = rows.values(stage_of(p, v, 0.1));
    EXPECT_NEAR(g(0), -signed_distance(around.obstacles[0], p) - 0.5 - bulge(0.1), 1e-12);
    EXPECT_NEAR(g(1), -signed_distance(around.obstacles[1], p) - asked_of(0.5, v.norm(), 0.1),
                1e-12);
  }
  rows.expect_derivatives(stage_of({4, 3, 5}, {2, 1, 0}, 0.1), "inside");
  rows.expect_derivatives(stage_of({1, -0.7, 5}, {2, 1, 0}, 0.1), "inside, off the reflex corner");
  rows.expect_derivatives(stage_of({-30, 29, 50}, {2, 1, 0}, 0.1), "outside");
}

TEST(FlightZone, ThePathBetweenStagesStaysInside) {
  const Environment around = in_a_yard();
  const BoundRows rows("obstacle", map_of({}), around);
  Random random(7);
  int feasible = 0;
  for (int k = 0; k < 40000; ++k) {
    const Vector3d from(random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(0, 30));
    const double h = random.uniform(0.05, 0.4);
    const Vector3d v = random.uniform(0, 10) *
                       Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Vector3d a = drone_acceleration() *
                       Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const auto at = [&](double t) -> Vector3d { return from + t * v + t * t / 2 * a; };
    if (rows.values(stage_of(from, v, h)).minCoeff() < 0) continue;
    if (rows.values(stage_of(at(h), v + h * a, h)).minCoeff() < 0) continue;
    ++feasible;
    for (int i = 0; i <= 20; ++i)
      for (const Obstacle& zone : around.obstacles)
        EXPECT_LE(signed_distance(zone, at(h * i / 20)), -0.5 + 1e-9);
  }
  EXPECT_GT(feasible, 3000);
}

Value region(double start, double finish, const std::vector<double>& lower,
             const std::vector<double>& size) {
  return map_of(
      {{"start", start}, {"finish", finish}, {"lower", list_of(lower)}, {"size", list_of(size)}});
}
Value regions(const std::vector<Value>& all) {
  Value list = Value::list();
  for (const Value& one : all) list.push_back(one);
  return map_of({{"regions", list}});
}

// How far the position of a stage is beyond the tightest face; negative inside.
double beyond(const BoundRows& rows, int instance, const Vector3d& p) {
  Eigen::VectorXd x(4);
  x << p, rows.horizon.step;
  std::vector<double> lower(static_cast<std::size_t>(rows.shape.rows)), upper(lower.size());
  rows.function->bounds({instance, 1}, lower.data(), upper.data());
  const Eigen::VectorXd g = rows.values(x, instance);
  double worst = -1e9;
  for (int r = 0; r < rows.shape.rows; ++r)
    worst = std::max(worst, g(r) - upper[static_cast<std::size_t>(r)]);
  return worst;
}

TEST(Corridor, StagesLieInTheRegionsOfTheStepsOnBothSides) {
  // Steps end at 0.1, 0.2, ...; the second region begins in the middle of the fifth.
  const Value given =
      regions({region(0, 0.43, {0, 0, 0}, {4, 2, 2}), region(0.43, 1, {3, 0, 0}, {9, 2, 2})});
  const BoundRows rows("corridor", given);
  ASSERT_EQ(rows.shape.stages.size(), 11u);
  EXPECT_TRUE(rows.shape.affine);
  EXPECT_LT(beyond(rows, 0, {1, 1, 1}), 0);
  EXPECT_NEAR(beyond(rows, 0, {4.5, 1, 1}), 0.5 + bulge(0.1), 1e-12);
  EXPECT_LT(beyond(rows, 9, {11, 1, 1}), 0);
  EXPECT_NEAR(beyond(rows, 9, {2, 1, 1}), 1 + bulge(0.1), 1e-12);
  // The middle of the step from 0.4 to 0.5 lies in the second one: 0.4 s is in both.
  EXPECT_LT(beyond(rows, 4, {3.5, 1, 1}), 0);
  EXPECT_GT(beyond(rows, 4, {2.5, 1, 1}), 0);
  EXPECT_GT(beyond(rows, 4, {4.5, 1, 1}), 0);
  Eigen::VectorXd x(4);
  x << 1, 1, 1, 0.1;
  EXPECT_LT((rows.jacobian(x, 4) - rows.jacobian(2 * x, 4)).leftCols(3).norm(), 1e-12);
}

TEST(Corridor, HalfSpacesCutTheBox) {
  Value half = map_of({{"normal", list_of({1, 1, 0})}, {"offset", 3.0}});
  Value one = region(0, 1, {0, 0, 0}, {4, 4, 4});
  Value halves = Value::list();
  halves.push_back(half);
  one.set("half_spaces", halves);
  const BoundRows rows("corridor", regions({one}));
  EXPECT_EQ(rows.shape.rows, 7);
  EXPECT_LT(beyond(rows, 2, {1, 1, 1}), 0);
  EXPECT_NEAR(beyond(rows, 2, {2, 2, 2}), 1 / std::sqrt(2.0) + bulge(0.1), 1e-12);
}

TEST(Corridor, SpansWithoutARegionAskForNothing) {
  const BoundRows rows("corridor", regions({region(0.5, 0.8, {0, 0, 0}, {1, 1, 1})}));
  EXPECT_EQ(rows.shape.stages, (std::vector<int>{5, 6, 7, 8}));
}

TEST(Corridor, BadRegionsAreRefused) {
  expect_message(
      [] {
        BoundRows("corridor", regions({region(1, 0.5, {0, 0, 0}, {1, 1, 1})}));
      },
      {"ends before it begins"});
  expect_message(
      [] {
        BoundRows("corridor", regions({region(0, 0.5, {0, 0, 0}, {1, 1, 1}),
                                       region(0.5, 1, {5, 0, 0}, {1, 1, 1})}));
      },
      {"corridor", "no common point", "0.5 s"});
  expect_message(
      [] {
        BoundRows("corridor", regions({region(0, 1, {0, 0, 0}, {1, 0, 1})}));
      },
      {"size"});
}

}  // namespace
}  // namespace lapwing
