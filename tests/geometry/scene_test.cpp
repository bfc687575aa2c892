// SPDX-License-Identifier: Apache-2.0
// Rays with known answers, and all of them against a plain search through the shapes.
#include <gtest/gtest.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/scene.h"
#include "framework/geometry/shape_hits.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

const Vector3d kEast = Vector3d::UnitX(), kUp = Vector3d::UnitZ();

RayHit hit_of(const Scene& scene, const Vector3d& origin, const Vector3d& direction) {
  const auto hit = scene.cast(origin, direction.normalized());
  if (!hit) throw Error("the ray hits nothing");
  EXPECT_NEAR(hit->normal.norm(), 1, 1e-12);
  EXPECT_LE(hit->normal.dot(direction), 0) << "the normal faces the ray";
  return *hit;
}

TEST(Scene, EmptyOneStopsNothing) {
  const Scene scene({});
  EXPECT_FALSE(scene.cast({0, 0, 0}, kEast));
  EXPECT_FALSE(scene.blocked({0, 0, 0}, kEast));
}

TEST(Scene, BallHasKnownHits) {
  const Scene scene({BallShape{{10, 0, 0}, 2}});
  const RayHit front = hit_of(scene, {0, 0, 0}, kEast);
  EXPECT_NEAR(front.distance, 8, 1e-12);
  EXPECT_TRUE(front.normal.isApprox(-kEast));
  EXPECT_EQ(front.shape, 0);
  EXPECT_NEAR(hit_of(scene, {0, 1.2, 0}, kEast).distance, 8.4, 1e-12);  // 2, 1.2, 1.6
  EXPECT_NEAR(hit_of(scene, {10, 0, 0}, kUp).distance, 2, 1e-12);       // from inside
  EXPECT_FALSE(scene.cast({0, 2.001, 0}, kEast));
  EXPECT_FALSE(scene.cast({13, 0, 0}, kEast));  // behind
  EXPECT_TRUE(scene.blocked({0, 0, 0}, kEast, 8.01));
  EXPECT_FALSE(scene.blocked({0, 0, 0}, kEast, 7.99));
}

TEST(Scene, BlockHasKnownHits) {
  const Scene scene({BlockShape{{1, -1, 0}, {3, 1, 4}}});
  EXPECT_NEAR(hit_of(scene, {0, 0, 1}, kEast).distance, 1, 1e-12);
  EXPECT_TRUE(hit_of(scene, {0, 0, 1}, kEast).normal.isApprox(-kEast));
  const RayHit top = hit_of(scene, {2, 0, 10}, {0, 0.1, -1});
  EXPECT_NEAR(top.distance, 6 * std::sqrt(1.01), 1e-12);
  EXPECT_TRUE(top.normal.isApprox(kUp));
  EXPECT_NEAR(hit_of(scene, {2, 0, 1}, kEast).distance, 1, 1e-12);  // from inside
  EXPECT_FALSE(scene.cast({0, 1.01, 1}, kEast));
}

TEST(Scene, BoardIsSeenFromBothSides) {
  const Scene scene({BoardShape{{5, 0, 2}, {0, 3, 0}, {0, 0, 1}}});
  EXPECT_NEAR(hit_of(scene, {0, 2.9, 1.1}, kEast).distance, 5, 1e-12);
  EXPECT_NEAR(hit_of(scene, {9, -2.9, 2.9}, -kEast).distance, 4, 1e-12);
  EXPECT_FALSE(scene.cast({0, 3.01, 2}, kEast));
  EXPECT_FALSE(scene.cast({0, 0, 3.01}, kEast));
  EXPECT_FALSE(scene.cast({5, -9, 2}, Vector3d::UnitY()));  // along it
}

TEST(Scene, CylinderHasSidesAndCaps) {
  const Scene scene({UprightCylinderShape{{0, 0, 3}, 6, 2}});
  const RayHit side = hit_of(scene, {-5, 0, 3}, kEast);
  EXPECT_NEAR(side.distance, 4, 1e-12);
  EXPECT_TRUE(side.normal.isApprox(-kEast));
  EXPECT_NEAR(hit_of(scene, {-5, 0.6, 3}, kEast).distance, 4.2, 1e-12);  // 1, 0.6, 0.8
  const RayHit cap = hit_of(scene, {0.5, 0.5, 20}, -kUp);
  EXPECT_NEAR(cap.distance, 14, 1e-12);
  EXPECT_TRUE(cap.normal.isApprox(kUp));
  EXPECT_NEAR(hit_of(scene, {0, 0, 3}, kEast).distance, 1, 1e-12);  // from inside
  EXPECT_NEAR(hit_of(scene, {-2, 0, 8}, {1, 0, -1}).distance, 2 * std::sqrt(2), 1e-12);
  EXPECT_FALSE(scene.cast({-5, 0, 6.01}, kEast));
  EXPECT_FALSE(scene.cast({0.8, 0.8, 20}, -kUp));
}

TEST(Scene, GroundIsEndless) {
  const Scene scene({GroundShape{-1}});
  EXPECT_NEAR(hit_of(scene, {3, 4, 9}, -kUp).distance, 10, 1e-12);
  EXPECT_NEAR(hit_of(scene, {0, 0, 99}, {100, 0, -1}).distance, 100 * std::sqrt(10001), 1e-6);
  EXPECT_FALSE(scene.cast({0, 0, 9}, kEast));
  EXPECT_FALSE(scene.cast({0, 0, 9}, kUp));
  EXPECT_TRUE(hit_of(scene, {0, 0, -5}, kUp).normal.isApprox(-kUp));
}

TEST(Scene, NearestShapeWinsAndTheFirstOfEqualOnes) {
  const Scene scene(
      {GroundShape{0}, BallShape{{10, 0, 5}, 1}, BallShape{{7, 0, 5}, 1}, BallShape{{7, 0, 5}, 1}});
  EXPECT_EQ(hit_of(scene, {0, 0, 5}, kEast).shape, 2);
  EXPECT_EQ(hit_of(scene, {20, 0, 5}, -kEast).shape, 1);
  EXPECT_EQ(hit_of(scene, {7, 0, 2}, -kUp).shape, 0);
}

TEST(Scene, EqualsASearchThroughAllShapesFarFromTheOriginToo) {
  for (const double far : {0.0, 9e4}) {
    Random random(7);
    const auto number = [&](double low, double high) { return random.uniform(low, high); };
    const auto place = [&] {
      return Vector3d(far + number(-20, 20), number(-20, 20), number(-20, 20));
    };
    std::vector<BodyShape> shapes;
    for (int i = 0; i < 40; ++i) {
      const Vector3d p = place();
      shapes.push_back(BallShape{p, number(0.1, 2)});
      shapes.push_back(BlockShape{p, p + Vector3d(number(0.1, 2), 1, number(0.1, 3))});
      shapes.push_back(UprightCylinderShape{place(), number(0.1, 4), number(0.1, 2)});
      const Vector3d across = Vector3d(number(-1, 1), number(-1, 1), 0.3).normalized();
      shapes.push_back(BoardShape{place(), 2 * across, across.cross(kUp)});
    }
    shapes.push_back(GroundShape{-19});
    const Scene scene(shapes);
    int hits = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vector3d origin = place();
      const Vector3d direction = (place() - origin).normalized();
      std::optional<RayHit> expected;
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        const auto found = hit(shapes[k], {origin, direction});
        if (found && (!expected || found->distance < expected->distance)) {
          expected = RayHit{found->distance, static_cast<int>(k), found->normal};
        }
      }
      const auto found = scene.cast(origin, direction);
      ASSERT_EQ(found.has_value(), expected.has_value()) << i;
      EXPECT_EQ(scene.blocked(origin, direction), expected.has_value()) << i;
      if (!expected) continue;
      ++hits;
      EXPECT_EQ(found->shape, expected->shape) << i;
      EXPECT_EQ(found->distance, expected->distance) << i;
      EXPECT_FALSE(scene.blocked(origin, direction, 0.999 * expected->distance));
    }
    EXPECT_GT(hits, 2000);
  }
}

TEST(Scene, RefusesShapesThatAreNone) {
  const double nan = std::nan("");
  for (const BodyShape& shape : std::vector<BodyShape>{
           BallShape{{0, 0, 0}, 0}, BallShape{{0, 0, nan}, 1}, BallShape{{0, 0, 0}, nan},
           BallShape{{2e5, 0, 0}, 1}, BlockShape{{0, 0, 0}, {1, 0, 1}},
           BlockShape{{0, 0, 0}, {1, INFINITY, 1}}, BoardShape{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}},
           BoardShape{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, UprightCylinderShape{{0, 0, 0}, 0, 1},
           UprightCylinderShape{{0, 0, 0}, 1, 0}, GroundShape{nan}}) {
    EXPECT_THROW(Scene({BallShape{{0, 0, 0}, 1}, shape}), InputError);
  }
  try {
    Scene({BallShape{{0, 0, 0}, 1}, BallShape{{0, 0, 0}, -1}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "shape 2 of the scene: a ball needs a radius above 0");
  }
}

}  // namespace
}  // namespace lapwing
