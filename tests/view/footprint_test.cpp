// SPDX-License-Identifier: Apache-2.0
#include "framework/view/footprint.h"

#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

const Pinhole kCamera{80, 60, 40, 40, 39.5, 29.5};

double area_of(const std::vector<Eigen::Vector2d>& corners) {
  double twice = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d &p = corners[k], &q = corners[(k + 1) % corners.size()];
    twice += p.x() * q.y() - q.x() * p.y();
  }
  return twice / 2;
}

bool contains(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& at) {
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d p = corners[k], way = corners[(k + 1) % corners.size()] - p;
    if (way.x() * (at - p).y() - way.y() * (at - p).x() < 0) return false;
  }
  return !corners.empty();
}

// Straight down from 20 m over the level: 40 m by 30 m, as the pixels are 0.5 m there.
TEST(Footprint, StraightDownIsARectangle) {
  const auto corners = footprint_of({{3, 4, 25}, 0, -std::numbers::pi / 2}, kCamera, 5, 100);
  ASSERT_EQ(corners.size(), 4u);
  EXPECT_NEAR(area_of(corners), 40 * 30, 1e-9);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : corners) mean += p / 4;
  EXPECT_NEAR((mean - Eigen::Vector2d(3, 4)).norm(), 0, 1e-9);
  EXPECT_NEAR(std::abs(corners[0].x() - 3), 15, 1e-9);
  EXPECT_NEAR(std::abs(corners[0].y() - 4), 20, 1e-9);
}

// Of places on the ground those are in it whose pixel is in the image and that are near enough.
TEST(Footprint, HoldsThePlacesThatTheImageShows) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double pitch : {-70.0, -45.0, -30.0, -10.0}) {
    const Viewpoint view{{2, -3, 18}, 0.7, radians(pitch)};
    const auto corners = footprint_of(view, kCamera, 1, 60);
    ASSERT_GE(corners.size(), 3u) << pitch;
    const Pose camera = view.camera();
    int inside = 0;
    for (int k = 0; k < 4000; ++k) {
      const Eigen::Vector3d p(2 + 60 * any(random), -3 + 60 * any(random), 1);
      const Eigen::Vector3d c = camera.orientation.inverse() * (p - view.position);
      const double u = kCamera.focal_x * c.x() / c.z() + kCamera.principal_x;
      const double v = kCamera.focal_y * c.y() / c.z() + kCamera.principal_y;
      const bool in_image = c.z() > 0 && u >= -0.5 && u <= 79.5 && v >= -0.5 && v <= 59.5;
      const bool in = contains(corners, p.head<2>());
      ASSERT_EQ(in, in_image && c.z() <= 60) << pitch << ": " << p.transpose();
      inside += in;
    }
    EXPECT_GT(inside, 50);
  }
}

TEST(Footprint, ThereIsNoneAboveTheHorizonOrBeyondTheRange) {
  EXPECT_TRUE(footprint_of({{0, 0, 20}, 0, 0.9}, kCamera, 0, 100).empty());
  EXPECT_TRUE(footprint_of({{0, 0, 20}, 0, -1.5}, kCamera, 0, 10).empty());
  EXPECT_THROW(footprint_of({{0, 0, 20}, 0, -1.5}, kCamera, 0, 0), InputError);
}

}  // namespace
}  // namespace lapwing
