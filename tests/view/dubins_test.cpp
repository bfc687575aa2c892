// SPDX-License-Identifier: Apache-2.0
#include "framework/view/dubins.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

double length(const CoursePoint& a, const CoursePoint& b, double radius) {
  return shortest_dubins_way(a, b, radius).length();
}

CoursePoint anywhere(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-4, 4)};
}

TEST(Dubins, KnownLengths) {
  EXPECT_NEAR(length({0, 0, 0}, {7, 0, 0}, 2), 7, 1e-12);
  EXPECT_EQ(length({1, 2, 3}, {1, 2, 3}, 2), 0);
  // Half a circle to the line beside, two radii away.
  EXPECT_NEAR(length({0, 0, 0}, {0, 6, std::numbers::pi}, 3), 3 * std::numbers::pi, 1e-9);
  // A quarter of a turn, and a straight line behind it.
  EXPECT_NEAR(length({0, 0, 0}, {3, 13, std::numbers::pi / 2}, 3), 3 * std::numbers::pi / 2 + 10,
              1e-9);
  // Back where it came from: three arcs of a bulb, 60, 300 and 60 degrees (Dubins 1957).
  EXPECT_NEAR(length({0, 0, 0}, {0, 0, std::numbers::pi}, 1), 7 * std::numbers::pi / 3, 1e-9);
}

TEST(Dubins, EveryWayEndsWhereItShould) {
  Random random(3);
  for (int k = 0; k < 5000; ++k) {
    const double radius = random.uniform(0.5, 3);
    const CoursePoint a = anywhere(random, 5), b = anywhere(random, 5);
    const DubinsWay way = shortest_dubins_way(a, b, radius);
    const CoursePoint end = way.at(way.length());
    EXPECT_NEAR(end.x, b.x, 1e-8) << k;
    EXPECT_NEAR(end.y, b.y, 1e-8) << k;
    EXPECT_NEAR(std::remainder(end.course - b.course, 2 * std::numbers::pi), 0, 1e-8) << k;
    EXPECT_GE(way.length() + 1e-9, std::hypot(b.x - a.x, b.y - a.y));
    for (const DubinsWay::Part& part : way.parts) {
      EXPECT_GE(part.length, 0);
      EXPECT_LE(part.length, 2 * std::numbers::pi * radius + 20);
      EXPECT_TRUE(part.curvature == 0 || std::abs(std::abs(part.curvature) - 1 / radius) < 1e-12);
    }
  }
}

// A shortest way is no longer than by any place between, and as long backwards and in a mirror: a
// word that is missing or wrong breaks one of these somewhere.
TEST(Dubins, NothingIsShorter) {
  Random random(8);
  for (int k = 0; k < 5000; ++k) {
    const CoursePoint a = anywhere(random, 3), b = anywhere(random, 3), c = anywhere(random, 3);
    const double straight = length(a, c, 1);
    ASSERT_LE(straight, length(a, b, 1) + length(b, c, 1) + 1e-9) << k;
    const CoursePoint back_a{a.x, a.y, a.course + std::numbers::pi},
        back_c{c.x, c.y, c.course + std::numbers::pi};
    ASSERT_NEAR(straight, length(back_c, back_a, 1), 1e-8) << k;
    ASSERT_NEAR(straight, length({a.x, -a.y, -a.course}, {c.x, -c.y, -c.course}, 1), 1e-8) << k;
  }
}

TEST(Dubins, ARadiusIsAboveNothing) {
  EXPECT_THROW(shortest_dubins_way({}, {1, 0, 0}, 0), InputError);
  EXPECT_THROW(shortest_dubins_way({}, {1, 0, 0}, std::nan("")), InputError);
}

}  // namespace
}  // namespace lapwing
