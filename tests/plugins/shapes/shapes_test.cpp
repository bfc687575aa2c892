// SPDX-License-Identifier: Apache-2.0
// Shapes: their distances against the verifier's, which is written anew; surfaces, rays, records.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/shape/lifted_distance.h"
#include "tests/obstacles.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kFar = std::numeric_limits<double>::infinity();

std::vector<Obstacle> examples() {
  const auto at = place_value;
  Environment all;
  all.obstacles = {
      sphere_at("ball", {1, 2, 3}, 4),
      box_at("house", {-2, -1, 0}, {2, 3, 5}),
      zone_at("court", {{0, 0}, {6, 0}, {6, 5}, {4, 5}, {4, 2}, {2, 2}, {2, 5}, {0, 5}}, 1, 4),
      zone_at("field", {{-4, -6}, {-4, 4}, {6, -6}}),
      zone_at("roof", {{-4, -6}, {6, -6}, {-4, 4}}, 3),
      obstacle_at("pole", "capsule",
                  {{"from", at({-3, 0, 1})}, {"to", at({2, 4, 6})}, {"radius", 1.5}}),
      obstacle_at("dot", "capsule",
                  {{"from", at({1, 1, 1})}, {"to", at({1, 1, 1})}, {"radius", 2.0}}),
      obstacle_at("tent", "cone", {{"base", at({1, -1, 2})}, {"radius", 3.0}, {"height", 4.0}}),
      obstacle_at("fir", "cone", {{"base", at({0, 2, -5})}, {"radius", 1.0}, {"height", 9.0}}),
      obstacle_at("slope", "half_space", {{"point", at({0, 1, 2})}, {"normal", at({0.5, -1, 2})}})};
  return with_shapes(all).obstacles;
}

TEST(Shapes, DistancesAreThoseOfTheVerifier) {
  Random random(3);
  for (const Obstacle& obstacle : examples()) {
    for (int k = 0; k < 4000; ++k) {
      const Vector3d p(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 12));
      EXPECT_NEAR(obstacle.shape->distance(p, nullptr), signed_distance(obstacle, p), 1e-9)
          << obstacle.name << " at " << p.transpose();
    }
  }
}

TEST(Shapes, GradientsLeadOutEvenFromTheCore) {
  const auto all = examples();
  for (const auto& [which, place] :
       {std::pair<std::size_t, Vector3d>{0, {1, 2, 3}}, {5, {-0.5, 2, 3.5}}, {6, {1, 1, 1}}}) {
    const Shape& shape = *all[which].shape;
    Vector3d out;
    const double here = shape.distance(place, &out);
    EXPECT_NEAR(out.norm(), 1, 1e-9) << all[which].name;
    EXPECT_NEAR(shape.distance(place + 0.5 * out, nullptr) - here, 0.5, 1e-3) << all[which].name;
  }
}

// What constraints read: value, slope and curvature through duals of duals.
TEST(Shapes, DistancesAreCarriedThroughDualNumbers) {
  using Inner = Dual<double, 2>;
  using Outer = Dual<Inner, 2>;
  Random random(5);
  for (const Obstacle& obstacle : examples()) {
    const Shape& shape = *obstacle.shape;
    for (int k = 0; k < 50; ++k) {
      const Vector3d at(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 12));
      const Vector3d a(random.normal(), random.normal(), random.normal());
      const Vector3d b(random.normal(), random.normal(), random.normal());
      Outer p[3];
      for (int i = 0; i < 3; ++i) {
        p[i] = Outer(at(i));
        p[i].v.d = {a(i), b(i)};
        p[i].d[0] = Inner(a(i));
        p[i].d[1] = Inner(b(i));
      }
      const Outer lifted = lifted_distance(shape, static_cast<const Outer*>(p));
      Vector3d gradient;
      const double value = shape.distance(at, &gradient);
      EXPECT_NEAR(lifted.v.v, value, 1e-12) << obstacle.name;
      EXPECT_NEAR(lifted.v.d[0], gradient.dot(a), 1e-9);
      EXPECT_NEAR(lifted.d[1].v, gradient.dot(b), 1e-9);
      EXPECT_NEAR(lifted.d[0].d[1], a.dot(shape.curvature(at) * b), 1e-9) << obstacle.name;
    }
  }
}

TEST(Shapes, RaysEndWhereTheVerifierSeesTheSurface) {
  Random random(7);
  for (const Obstacle& obstacle : examples()) {
    int hits = 0, misses = 0;
    for (int k = 0; k < 500; ++k) {
      const Vector3d from(random.uniform(-15, 15), random.uniform(-15, 15),
                          random.uniform(-15, 15));
      const Vector3d towards(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-5, 7));
      const Vector3d way = (towards - from).normalized();
      if (std::abs(signed_distance(obstacle, from)) < 0.01) continue;
      const auto hit = obstacle.shape->hit(from, way);
      (hit ? hits : misses) += 1;
      if (hit) {
        EXPECT_NEAR(signed_distance(obstacle, from + hit->distance * way), 0, 1e-5)
            << obstacle.name;
        EXPECT_LT(hit->normal.dot(way), 1e-6) << obstacle.name;
      }
      if (signed_distance(obstacle, from) < 0) {
        continue;
      }
      const bool hidden = judged_form(obstacle)->hides(from, from + 30 * way, 0);
      const bool end_inside = signed_distance(obstacle, from + 30 * way) < 0;
      if (!end_inside && hidden) {
        EXPECT_TRUE(hit && hit->distance < 30) << obstacle.name << " from " << from.transpose();
      }
    }
    EXPECT_GT(hits, 20) << obstacle.name;
    EXPECT_GT(misses, 20) << obstacle.name;
  }
}

TEST(Shapes, WrongParametersAreRefused) {
  const auto message = [](const Obstacle& obstacle) -> std::string {
    Environment one;
    one.obstacles = {obstacle};
    try {
      with_shapes(one);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message(box_at("", {0, 0, 0}, {1, 0, 1})), HasSubstr("lower must be below upper"));
  EXPECT_THAT(message(sphere_at("", {0, 0, 0}, 0)), HasSubstr("radius"));
  EXPECT_THAT(message(zone_at("", {{0, 0}, {1, 0}})), HasSubstr("at least three pairs"));
  EXPECT_THAT(message(zone_at("", {{0, 0}, {2, 2}, {2, 0}, {0, 2}})), HasSubstr("cross or touch"));
  EXPECT_THAT(message(zone_at("", {{0, 0}, {1, 0}, {0, 1}}, 3, 2)), HasSubstr("above its floor"));
  EXPECT_THAT(
      message(obstacle_at("", "half_space",
                          {{"point", place_value({0, 0, 0})}, {"normal", place_value({0, 0, 0})}})),
      HasSubstr("not zero"));
  EXPECT_THAT(message(obstacle_at("", "cylindre", {})), HasSubstr("unknown shape 'cylindre'"));
}

TEST(Shapes, SurfacesStayWithinTheirTolerance) {
  const Eigen::AlignedBox3d within(Vector3d::Constant(-20), Vector3d::Constant(20));
  for (const Obstacle& obstacle : examples())
    for (const double tolerance : {0.2, 0.01}) {
      const TriangleMesh mesh = obstacle.shape->triangles(tolerance, within);
      EXPECT_EQ(open_edges(mesh), "") << obstacle.name;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
        if ((middle.cwiseAbs().array() > 19.99).any()) continue;  // the faces of the box
        if (obstacle.name == "field" || obstacle.name == "roof") {
          if (std::abs(middle.z()) > 19.9) continue;  // cut where it has no end
        }
        EXPECT_LE(std::abs(signed_distance(obstacle, middle)), tolerance) << obstacle.name;
      }
    }
}

}  // namespace
}  // namespace lapwing
