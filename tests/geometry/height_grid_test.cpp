// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/core/error.h"
#include "framework/geometry/height_grid.h"

namespace lapwing {
namespace {

constexpr float kGap = std::numeric_limits<float>::quiet_NaN();

TEST(HeightGrid, BilinearBetweenItsPoints) {
  // z = 1 + 2 x + 3 y + x y, which is bilinear, on points half a metre apart.
  const auto z = [](double x, double y) { return 1 + 2 * x + 3 * y + x * y; };
  std::vector<float> heights;
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 4; ++column)
      heights.push_back(static_cast<float>(z(10 + 0.5 * column, -2 + 0.5 * row)));
  const HeightGrid grid({10, -2}, 0.5, 4, heights);
  EXPECT_EQ(grid.rows(), 5);
  for (const double x : {10.0, 10.25, 10.9, 11.5})
    for (const double y : {-2.0, -1.6, -1.0, 0.0})
      EXPECT_NEAR(grid.height(x, y).value(), z(x, y), 1e-5) << x << " " << y;
  for (const auto& [x, y] : {std::pair{9.99, -1.0}, {11.51, -1.0}, {10.5, -2.01}, {10.5, 0.01}})
    EXPECT_FALSE(grid.height(x, y)) << x << " " << y;
  EXPECT_FALSE(grid.height(std::nan(""), 0));
  EXPECT_EQ(grid.known(), 1);
  EXPECT_TRUE(grid.bounds().min().isApprox(Eigen::Vector3d(10, -2, z(10, -2))));
}

TEST(HeightGrid, GapsAreUnknown) {
  const HeightGrid grid({0, 0}, 1, 3, {0, 1, 2, 0, kGap, 2, 0, 1, 2});
  EXPECT_FALSE(grid.height(0.5, 0.5));
  EXPECT_FALSE(grid.height(1, 1));
  EXPECT_EQ(grid.height(0.5, 0), 0.5) << "between two known points";
  EXPECT_EQ(grid.height(2, 1), 2);
  EXPECT_NEAR(grid.known(), 8.0 / 9, 1e-12);
}

TEST(HeightGrid, WhatMakesNoSenseIsRefused) {
  EXPECT_THROW(HeightGrid({0, 0}, 0, 2, {0, 0, 0, 0}), InputError);
  EXPECT_THROW(HeightGrid({0, 0}, 1, 2, {0, 0, 0}), InputError);
  EXPECT_THROW(HeightGrid({0, 0}, 1, 1, {0, 0, 0, 0}), InputError);
  EXPECT_THROW(HeightGrid({0, 0}, 1, 2, {kGap, kGap, kGap, kGap}), InputError);
  EXPECT_THROW(HeightGrid({0, 0}, 1, 2, {0, 0, 0, std::numeric_limits<float>::infinity()}),
               InputError);
}

}  // namespace
}  // namespace lapwing
