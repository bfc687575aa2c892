// SPDX-License-Identifier: Apache-2.0
// Obstacles, zones and subjects: known distances, derivatives, and the path between stages.
#include <functional>

#include "framework/core/random.h"
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// The drone's largest acceleration: 4 across, and down as it falls or up as its rotors can.
double acceleration() {
  const Vehicle drone = camera_drone();
  return std::hypot(4.0, std::max(kGravity, drone.thrust_max() / drone.mass - kGravity));
}

Environment surroundings() {
  Environment environment;
  // A "U" open to the north, 2 wide inside; a triangle in the other turn, without top or bottom;
  // one with a floor alone.
  environment.obstacles = {
      sphere_at("ball", {1, 2, 3}, 4),
      sphere_at("", {0, -20, 0}, 1),
      box_at("house", {-2, -1, 0}, {2, 3, 5}),
      box_at("", {30, 30, 0}, {31, 31, 9}),
      zone_at("court", {{0, 0}, {6, 0}, {6, 5}, {4, 5}, {4, 2}, {2, 2}, {2, 5}, {0, 5}}, 1, 4),
      zone_at("field", {{20, 0}, {20, 10}, {30, 0}}),
      zone_at("", {{-9, -9}, {-5, -9}, {-5, -5}, {-9, -5}}, 10)};
  environment.subjects = {
      {"walker", {0.25, 1.25, 2.25}, {{0, 0, 1}, {2, 0, 1}, {2, -1, 1}}, 1.8, 1},
      {"still", {0}, {{9, 9, 1}}}};
  environment.margin = 0.5;
  return with_shapes(environment);
}

Environment of_type(const char* type) {
  return only(surroundings(), type);
}

// What the rows ask of a stage that must keep `distance`.
double asked(double distance, double speed, double h, double subject_speed = 0) {
  const double a = acceleration();
  const double length = (std::sqrt(speed * speed + 1e-4) + subject_speed) * h + a * h * h / 2;
  const double kept = distance + a * h * h / 8 + subject_speed * h / 2;
  return std::sqrt(kept * kept + length * length / 4);
}

// position[3] velocity[3] (time) step
Eigen::VectorXd stage(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity, double h) {
  Eigen::VectorXd x(7);
  x << position, velocity, h;
  return x;
}
Eigen::VectorXd stage_at(double time, const Eigen::Vector3d& position,
                         const Eigen::Vector3d& velocity, double h) {
  Eigen::VectorXd x(8);
  x << position, velocity, time, h;
  return x;
}

TEST(Obstacles, RowsAreDistancesLessWhatThePathNeeds) {
  const BoundRows spheres("obstacle", map_of({}), of_type("sphere"));
  const BoundRows boxes("obstacle", map_of({}), of_type("box"));
  const BoundRows zones("obstacle", map_of({}), of_type("prism"));
  EXPECT_EQ(spheres.shape.row_names, (std::vector<std::string>{"ball", "2"}));
  EXPECT_EQ(boxes.shape.row_names, (std::vector<std::string>{"house", "2"}));
  EXPECT_EQ(zones.shape.row_names, (std::vector<std::string>{"court", "field", "3"}));
  const Environment around = surroundings();
  Random random(2);
  for (int k = 0; k < 3000; ++k) {
    const Eigen::Vector3d p(random.uniform(-12, 32), random.uniform(-12, 12),
                            random.uniform(-3, 14));
    const Eigen::Vector3d v(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-2, 2));
    const double h = random.uniform(0.02, 0.3);
    const double ask = asked(0.5, v.norm(), h);
    const Eigen::VectorXd s = spheres.values(stage(p, v, h)), b = boxes.values(stage(p, v, h)),
                          z = zones.values(stage(p, v, h));
    for (int i = 0; i < 2; ++i) {
      const double radius = i == 0 ? 4 : 1;
      const double to_center = signed_distance(around.obstacles[i], p) + radius;
      EXPECT_NEAR(s(i), to_center - asked(radius + 0.5, v.norm(), h), 1e-12);
      EXPECT_NEAR(b(i), signed_distance(around.obstacles[2 + i], p) - ask, 1e-12);
    }
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(z(i), signed_distance(around.obstacles[4 + i], p) - ask, 1e-12) << p.transpose();
  }
  // By hand: at rest 6 m from the middle of a ball of 4 m.
  EXPECT_NEAR(
      spheres.values(stage({7, 2, 3}, {0, 0, 0}, 0.1))(0),
      6 - std::hypot(4.5 + acceleration() * 0.01 / 8, (0.01 * 0.1 + acceleration() * 0.01 / 2) / 2),
      1e-12);
}

TEST(Obstacles, DerivativesHoldOutsideInsideAndAlongside) {
  const BoundRows spheres("obstacle", map_of({}), of_type("sphere"));
  const BoundRows boxes("obstacle", map_of({}), of_type("box"));
  const BoundRows zones("obstacle", map_of({}), of_type("prism"));
  const Eigen::Vector3d v(3, -1, 0.5), rest(0, 0, 0);
  for (const BoundRows* rows : {&spheres, &boxes, &zones}) {
    rows->expect_derivatives(stage({9, 7, 6}, v, 0.1), "outside");
    rows->expect_derivatives(stage({9, 7, 6}, rest, 0.1), "at rest", 0, 1e-5, 1e-5);
    rows->expect_derivatives(stage({1.2, 0.9, 2.3}, v, 0.1), "inside");
    rows->expect_derivatives(stage({3.2, 4.1, 2.2}, v, 0.2), "between the wings of the court");
    rows->expect_derivatives(stage({2.9, 1.7, 2.4}, v, 0.1), "inside its reflex corners");
    rows->expect_derivatives(stage({-1.2, -0.7, 4.6}, v, 0.1), "off a corner, above");
    rows->expect_derivatives(stage({-7, -6.5, 9.2}, v, 0.1), "below a floor");
    rows->expect_derivatives(stage({22, 3.2, -50}, v, 0.1), "in a zone without a floor");
  }
  boxes.expect_derivatives(stage({4, 5, 7}, v, 0.1), "off the corner of a box");
  boxes.expect_derivatives(stage({4, 5, 2}, v, 0.1), "off its edge");
}

TEST(Obstacles, TheWayOutShowsEverywhere) {
  const BoundRows spheres("obstacle", map_of({}), of_type("sphere"));
  const BoundRows boxes("obstacle", map_of({}), of_type("box"));
  const BoundRows zones("obstacle", map_of({}), of_type("prism"));
  const auto leads_out = [](const BoundRows& rows, int row, const Eigen::Vector3d& p) {
    const Eigen::VectorXd at = stage(p, {1, 0, 0}, 0.1);
    rows.expect_finite(at, "inside");
    const Eigen::Vector3d out = rows.jacobian(at).row(row).head<3>();
    EXPECT_NEAR(out.norm(), 1.0, 1e-9) << p.transpose();
    const double gained =
        rows.values(stage(p + 1e-3 * out, {1, 0, 0}, 0.1))(row) - rows.values(at)(row);
    EXPECT_NEAR(gained, 1e-3, 1e-6) << p.transpose();
  };
  leads_out(boxes, 0, {0, 1, 2.5});  // the middle, as far from east as from west
  leads_out(boxes, 0, {1.9, 1, 2.5});
  leads_out(zones, 0, {1, 2.5, 2.5});
  leads_out(zones, 1, {22, 2, 3});
  leads_out(spheres, 0, {1, 2, 3.5});
  const Eigen::VectorXd centre = stage({1, 2, 3}, {1, 0, 0}, 0.1);
  spheres.expect_finite(centre, "at the centre");
  EXPECT_EQ(spheres.jacobian(centre).row(0).head<3>(), Eigen::RowVector3d(0, 0, 1));
  // Corners and edges of the zones and the box themselves.
  const auto numbers = recorded_numbers(surroundings().obstacles[4].parameters, "corners");
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < numbers.size(); i += 2)
    corners.emplace_back(numbers[i], numbers[i + 1]);
  for (const Eigen::Vector2d& corner : corners)
    for (const double z : {0.0, 1.0, 2.0, 4.0, 9.0}) {
      zones.expect_finite(stage({corner.x(), corner.y(), z}, {0, 0, 0}, 0.1), "at a corner");
      if (z == 2.0) {
        const auto slope = zones.jacobian(stage({corner.x(), corner.y(), z}, {0, 0, 0}, 0.1));
        EXPECT_NEAR(slope.row(0).head<3>().norm(), 1.0, 1e-9) << corner.transpose();
      }
    }
  for (const double x : {-2.0, 2.0})
    for (const double z : {0.0, 2.5, 5.0})
      boxes.expect_finite(stage({x, 3, z}, {0, 0, 0}, 0.1), "on a corner of the box");
}

// A pair of stages joined by a parabola.
struct Arc {
  Eigen::Vector3d from, velocity, acceleration;
  double h;
  Eigen::Vector3d at(double t) const { return from + t * velocity + t * t / 2 * acceleration; }
  Eigen::Vector3d velocity_at(double t) const { return velocity + t * acceleration; }
};

// Random arcs as fast and as bent as the vehicle can fly; `near` says where they begin.
Arc random_arc(Random& random, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  Arc arc;
  for (int i = 0; i < 3; ++i) arc.from(i) = random.uniform(lower(i), upper(i));
  Eigen::Vector3d direction(random.normal(), random.normal(), random.normal());
  arc.velocity = random.uniform(0, 10) * direction.normalized();
  direction = {random.normal(), random.normal(), random.normal()};
  arc.acceleration = acceleration() * direction.normalized();
  arc.h = random.uniform(0.05, 0.4);
  return arc;
}

bool holds(const BoundRows& rows, int row, const Eigen::VectorXd& x) {
  return rows.values(x)(row) >= 0;
}

// Wherever both stages keep the rows, the arc between them keeps the distance; returns how close
// the closest arc came beyond it.
double closest_arc(const BoundRows& rows, int row, const Eigen::Vector3d& lower,
                   const Eigen::Vector3d& upper,
                   const std::function<double(const Eigen::Vector3d&)>& distance, double kept) {
  Random random(7);
  double closest = kUnbounded;
  int feasible = 0;
  for (int k = 0; k < 60000; ++k) {
    const Arc arc = random_arc(random, lower, upper);
    if (!holds(rows, row, stage(arc.from, arc.velocity, arc.h))) continue;
    if (!holds(rows, row, stage(arc.at(arc.h), arc.velocity_at(arc.h), arc.h))) continue;
    ++feasible;
    if (distance(arc.from) > kept + 10) continue;
    for (int i = 0; i <= 40; ++i) {
      const double d = distance(arc.at(arc.h * i / 40)) - kept;
      EXPECT_GE(d, -1e-9);
      closest = std::min(closest, d);
    }
  }
  EXPECT_GT(feasible, 10000);
  return closest;
}

TEST(Obstacles, ThePathBetweenStagesKeepsTheMargin) {
  const Environment around = surroundings();
  const BoundRows spheres("obstacle", map_of({}), of_type("sphere"));
  const BoundRows boxes("obstacle", map_of({}), of_type("box"));
  const BoundRows zones("obstacle", map_of({}), of_type("prism"));
  // A small ball, which a fast chord may step over; the house; the court with its wings.
  const double ball = closest_arc(
      spheres, 1, {-4, -24, -4}, {4, -16, 4},
      [&](const Eigen::Vector3d& p) { return signed_distance(around.obstacles[1], p); }, 0.5);
  const double house = closest_arc(
      boxes, 0, {-5, -4, -3}, {5, 6, 8},
      [&](const Eigen::Vector3d& p) { return signed_distance(around.obstacles[2], p); }, 0.5);
  const double court = closest_arc(
      zones, 0, {-3, -3, -2}, {9, 8, 7},
      [&](const Eigen::Vector3d& p) { return signed_distance(around.obstacles[4], p); }, 0.5);
  // And it asks for little more than it must.
  EXPECT_LT(ball, 0.1);
  EXPECT_LT(house, 0.1);
  EXPECT_LT(court, 0.1);
}

TEST(Obstacles, StagesAloneWouldNotKeepIt) {
  // Two stages 2 m apart, each 0.6 m from the surface of a ball of 1 m: the chord between them
  // passes at 0.25 m. Distances at stages allow it, the rows do not.
  const Environment around = surroundings();
  const BoundRows spheres("obstacle", map_of({}), of_type("sphere"));
  const Eigen::Vector3d from(-1, -20, std::sqrt(1.6 * 1.6 - 1)), speed(10, 0, 0);
  EXPECT_GT(signed_distance(around.obstacles[1], from), 0.5);
  EXPECT_LT(spheres.values(stage(from, speed, 0.2))(1), 0);
  EXPECT_LT(signed_distance(around.obstacles[1], {0, -20, from.z()}), 0.5);
}

TEST(SubjectDistance, FollowsTheSubjectAndHoldsBetweenStages) {
  const Environment around = surroundings();
  const Value given = map_of({{"subject", "walker"}, {"distance", 3.0}});
  const BoundRows walker("subject_distance", given, around);
  const Subject& subject = around.subjects[0];
  const Eigen::Vector3d v(1, -2, 0.5);
  EXPECT_NEAR(walker.values(stage_at(0.75, {1, 7, 1}, v, 0.1))(0), 7 - asked(3, v.norm(), 0.1, 2.0),
              1e-12);
  walker.expect_derivatives(stage_at(0.75, {1, 7, 2}, v, 0.1), "beside it");
  walker.expect_derivatives(stage_at(0.75, {1.1, 0.1, 1.1}, v, 0.1), "almost in it");
  walker.expect_finite(stage_at(0.75, {1, 0, 1}, v, 0.1), "in its middle");
  EXPECT_EQ(walker.jacobian(stage_at(0.75, {1, 0, 1}, v, 0.1))(0, 2), 1);

  Random random(9);
  int feasible = 0;
  double closest = kUnbounded;
  for (int k = 0; k < 60000; ++k) {
    const Arc arc = random_arc(random, {-4, -5, -4}, {6, 5, 6});
    const double start = random.uniform(0, 2.2);
    if (!holds(walker, 0, stage_at(start, arc.from, arc.velocity, arc.h)) ||
        !holds(walker, 0, stage_at(start + arc.h, arc.at(arc.h), arc.velocity_at(arc.h), arc.h)))
      continue;
    ++feasible;
    for (int i = 0; i <= 40; ++i) {
      const double t = arc.h * i / 40;
      const double d = (arc.at(t) - subject.position(start + t)).norm() - 3;
      EXPECT_GE(d, -1e-9);
      closest = std::min(closest, d);
    }
  }
  EXPECT_GT(feasible, 10000);
  EXPECT_LT(closest, 0.3);
}

TEST(SubjectDistance, MeansAllSubjectsWithoutAName) {
  const BoundRows all("subject_distance", map_of({{"distance", 2.0}}), surroundings());
  EXPECT_EQ(all.shape.row_names, (std::vector<std::string>{"walker", "still"}));
  EXPECT_NEAR(all.values(stage_at(5, {9, 9, 11}, {0, 0, 0}, 0.1))(1), 10 - asked(2, 0, 0.1), 1e-12);
  expect_message(
      [] {
        BoundRows("subject_distance", map_of({{"distance", 2.0}, {"subject", "stil"}}),
                  surroundings());
      },
      {"no subject 'stil'", "did you mean 'still'"});
  expect_message([] { plugins().create<Constraint>("subject_distance"); }, {"distance"});
  expect_message(
      [] {
        plugins().create<Constraint>("subject_distance", map_of({{"distance", 0}}));
      },
      {"distance", "above 0"});
}

TEST(Obstacles, AnEmptyEnvironmentAddsNoRow) {
  TrajectoryProblem with = flight(9, 0.1), without = flight(9, 0.1);
  with.add_constraint("obstacle", plugins().create<Constraint>("obstacle"));
  with.add_constraint("subject_distance", plugins().create<Constraint>(
                                              "subject_distance", map_of({{"distance", 1.0}})));
  with.finish();
  without.finish();
  EXPECT_EQ(with.rows(), without.rows());
  EXPECT_TRUE(with.quadratic());
  const Stages at = with.initial_guess();
  LocalModel model;
  const Eigen::VectorXd multipliers = Eigen::VectorXd::Ones(with.rows());
  with.linearise(at, model, Curvature::exact, &multipliers);
  EXPECT_EQ(model.jacobian.rows(), with.rows());
  EXPECT_EQ(with.violations(at).size(), without.violations(at).size());
}

// A ball that flies east from 1 s on, seen at rest and on its way.
TEST(Obstacles, WhatMovesIsKeptClearOfWhereItIs) {
  Environment around;
  around.margin = 0.5;
  around.obstacles = {sphere_at("kite", {0, 0, 5}, 1)};
  around.obstacles[0].times = {1, 3};
  around.obstacles[0].moves = {{0, 0, 0}, {4, 0, 0}};
  const BoundRows rows("obstacle", map_of({}), with_shapes(around));
  const Eigen::Vector3d v(1, -2, 0.5);
  const auto at = [&](double time, const Eigen::Vector3d& p) {
    Eigen::VectorXd x(8);
    x << p, v, 0.1, time;
    return x;
  };
  EXPECT_NEAR(rows.values(at(0.5, {0, 6, 5}))(0), 6 - asked(1.5, v.norm(), 0.1, 2.0), 1e-12);
  EXPECT_NEAR(rows.values(at(2, {2, 6, 5}))(0), 6 - asked(1.5, v.norm(), 0.1, 2.0), 1e-12);
  EXPECT_NEAR(rows.values(at(9, {4, 6, 5}))(0), 6 - asked(1.5, v.norm(), 0.1, 2.0), 1e-12);
  rows.expect_derivatives(at(2, {1, 3, 6}), "on its way");
}

// What the verifier judges by triangles is kept clear of by their tolerance too.
TEST(Obstacles, TheToleranceOfTrianglesIsKeptBesideTheMargin) {
  Environment around = of_type("box");
  const BoundRows plain("obstacle", map_of({}), around);
  around.obstacles[0].tolerance = 0.25;
  const BoundRows kept("obstacle", map_of({}), around);
  const Eigen::VectorXd x = stage({5, 1, 2}, {0, 0, 0}, 0.1);
  EXPECT_NEAR(plain.values(x)(0) - kept.values(x)(0), asked(0.75, 0, 0.1) - asked(0.5, 0, 0.1),
              1e-12);
}

TEST(Obstacles, ViolationsNameTheObstacle) {
  TrajectoryProblem problem(camera_drone(), {.stages = 9, .step = 0.1}, of_type("sphere"));
  problem.add_model("quadrotor", plugins().create<VehicleModel>("quadrotor"));
  problem.add_constraint("obstacle", plugins().create<Constraint>("obstacle"));
  problem.set_path_guess({0, 0.8}, {{-7, 2, 3}, {9, 2, 3}}, {0, 0});
  problem.finish();
  const auto violations = problem.violations(problem.initial_guess());
  const auto named = [](const Violation& v) { return v.name == "obstacle"; };
  const auto found = std::find_if(violations.begin(), violations.end(), named);
  ASSERT_NE(found, violations.end());
  EXPECT_EQ(found->row, "obstacle.ball at 0.4 s");
}

}  // namespace
}  // namespace lapwing
