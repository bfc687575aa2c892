// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/core/random.h"
#include "framework/geometry/ground_span.h"
#include "framework/geometry/polygon.h"

namespace lapwing {
namespace {

constexpr float kUnknownGround = std::numeric_limits<float>::quiet_NaN();

// A slope that rises by 0.5 m per metre along x, 21 x 11 points 1 m apart from (-10, -5).
HeightGrid slope() {
  std::vector<float> heights;
  for (int row = 0; row < 11; ++row)
    for (int column = 0; column < 21; ++column)
      heights.push_back(static_cast<float>(0.5 * (column - 10)));
  return {{-10, -5}, 1, 21, heights};
}

TEST(GroundSpan, HoldsTheGroundWithinThePolygonAndNotMuchMore) {
  const auto span = ground_span(slope(), {{-2, -1}, {4, -1}, {4, 3}, {-2, 3}});
  ASSERT_TRUE(span);
  // The points around its edges reach up to a step beyond them.
  EXPECT_NEAR(span->lowest, -1, 0.5 + 1e-6);
  EXPECT_LE(span->lowest, -1);
  EXPECT_NEAR(span->highest, 2, 0.5 + 1e-6);
  EXPECT_GE(span->highest, 2);
  // One that lies between four points.
  const auto small = ground_span(slope(), {{0.2, 0.2}, {0.4, 0.2}, {0.3, 0.4}});
  ASSERT_TRUE(small);
  EXPECT_NEAR(small->lowest, 0, 1e-6);
  EXPECT_NEAR(small->highest, 0.5, 1e-6);
}

TEST(GroundSpan, NoHeightWithinThePolygonLiesBeyond) {
  Random random(7);
  std::vector<float> heights;
  for (int i = 0; i < 30 * 30; ++i) heights.push_back(static_cast<float>(random.uniform(-5, 5)));
  const HeightGrid ground({0, 0}, 0.5, 30, heights);
  const GroundPolygon star = {{1, 1}, {7, 5}, {13, 2}, {9, 7}, {12, 13}, {6, 9}, {2, 12}, {5, 6}};
  const auto span = ground_span(ground, star);
  ASSERT_TRUE(span);
  int inside = 0;
  for (double x = 0; x < 14.5; x += 0.07)
    for (double y = 0; y < 14.5; y += 0.07) {
      if (!polygon_contains(star, {x, y})) continue;
      ++inside;
      const double z = ground.height(x, y).value();
      EXPECT_GE(z, span->lowest - 1e-6) << x << " " << y;
      EXPECT_LE(z, span->highest + 1e-6) << x << " " << y;
    }
  EXPECT_GT(inside, 1000);
}

TEST(GroundSpan, PolygonsBeyondTheGridHaveWhatLiesOverIt) {
  const auto wide = ground_span(slope(), {{-1e5, -1e5}, {1e5, -1e5}, {1e5, 1e5}, {-1e5, 1e5}});
  ASSERT_TRUE(wide);
  EXPECT_NEAR(wide->lowest, -5, 1e-6);
  EXPECT_NEAR(wide->highest, 5, 1e-6);
  EXPECT_FALSE(ground_span(slope(), {{50, 50}, {60, 50}, {55, 60}}));
}

TEST(GroundSpan, GapsDoNotCount) {
  const HeightGrid ground({0, 0}, 1, 3,
                          {kUnknownGround, kUnknownGround, kUnknownGround, kUnknownGround,
                           kUnknownGround, kUnknownGround, kUnknownGround, kUnknownGround, 7});
  EXPECT_FALSE(ground_span(ground, {{0.1, 0.1}, {0.9, 0.1}, {0.5, 0.9}}));
  const auto span = ground_span(ground, {{-1, -1}, {3, -1}, {3, 3}, {-1, 3}});
  ASSERT_TRUE(span);
  EXPECT_EQ(span->lowest, 7);
  EXPECT_EQ(span->highest, 7);
}

}  // namespace
}  // namespace lapwing
