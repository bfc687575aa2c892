// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/convex_part.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace lapwing {
namespace {

using Eigen::Matrix3d;

TEST(ConvexPart, KeepsWhatIsConvexAndDropsTheRest) {
  const Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const auto form = [&](double a, double b, double c) {
    return Matrix3d(turn * Eigen::Vector3d(a, b, c).asDiagonal() * turn.transpose());
  };
  std::vector<double> blocks;
  for (const Matrix3d& m :
       {form(3, 2, 1), form(3, -2, 0), form(-1, -2, -3), Matrix3d(Matrix3d::Zero())})
    blocks.insert(blocks.end(), m.data(), m.data() + 9);
  take_convex_parts(blocks, 3);
  const Matrix3d expected[] = {form(3, 2, 1), form(3, 0, 0), Matrix3d::Zero(), Matrix3d::Zero()};
  for (int k = 0; k < 4; ++k)
    EXPECT_LT((Eigen::Map<Matrix3d>(blocks.data() + 9 * k) - expected[k]).norm(), 1e-12) << k;
}

}  // namespace
}  // namespace lapwing
