// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "framework/geometry/camera_view.h"

namespace lapwing {
namespace {

CameraView view_at(double yaw, double pitch) {
  return {{1920, 1080, 900, 910, 959.5, 539.5}, {1, 2, 3}, camera_axes(yaw, pitch)};
}

TEST(CameraView, LooksAlongYawAndPitch) {
  const CameraView north = view_at(std::numbers::pi / 2, 0);
  const auto centre = north.project({1, 12, 3});
  ASSERT_TRUE(centre);
  EXPECT_NEAR(centre->x(), 959.5, 1e-9);
  EXPECT_NEAR(centre->y(), 539.5, 1e-9);
  // East is to the right of north, up is towards smaller rows.
  EXPECT_NEAR(north.project({2, 12, 3})->x(), 959.5 + 90, 1e-9);
  EXPECT_NEAR(north.project({1, 12, 4})->y(), 539.5 - 91, 1e-9);
  const CameraView down = view_at(0, -std::numbers::pi / 2);
  EXPECT_NEAR(down.project({1, 2, -7})->x(), 959.5, 1e-9);
  EXPECT_NEAR(down.project({2, 2, -7})->y(), 539.5 - 91, 1e-9);  // ahead is up in the image
}

TEST(CameraView, SeesWhatIsInFrontAndInside) {
  const CameraView view = view_at(0, 0);
  EXPECT_FALSE(view.project({0, 2, 3}));  // behind
  EXPECT_FALSE(view.project({1, 2, 3}));  // at the camera
  const double edge = 10 * 960 / 900.0;   // the image's left edge 10 m ahead
  EXPECT_TRUE(view.sees({11, 2 + edge - 1e-6, 3}));
  EXPECT_FALSE(view.sees({11, 2 + edge + 1e-6, 3}));
  EXPECT_TRUE(view.sees({11, 2 - edge + 1e-6, 3}));
  EXPECT_FALSE(view.sees({11, 2 - edge - 1e-6, 3}));
}

TEST(CameraView, RayIsTheInverseOfProjection) {
  const CameraView view = view_at(0.7, -0.4);
  for (const double x : {-0.5, 100.0, 1919.5}) {
    for (const double y : {-0.5, 700.0}) {
      const Eigen::Vector3d ray = view.ray(x, y);
      EXPECT_NEAR(ray.norm(), 1, 1e-12);
      const auto pixel = view.project(view.position + 7 * ray);
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x(), x, 1e-8);
      EXPECT_NEAR(pixel->y(), y, 1e-8);
    }
  }
}

TEST(CameraView, ScalingKeepsTheView) {
  CameraView view = view_at(0.7, -0.4);
  const Eigen::Vector3d point = view.position + 9 * view.ray(-0.5, 1079.5);  // a corner
  const Pinhole whole = view.pinhole;
  for (const auto& [across, down, width, height] :
       std::vector<std::array<int, 4>>{{320, 320, 320, 180}, {500, 90, 160, 90}, {7, 7, 7, 4}}) {
    view.pinhole = whole.fitted(across, down);
    EXPECT_EQ(view.pinhole.width, width);
    EXPECT_EQ(view.pinhole.height, height);
    EXPECT_NEAR(view.project(point)->x(), -0.5, 1e-9);
    EXPECT_NEAR(view.project(point)->y(), height - 0.5, 1e-9);
  }
}

TEST(CameraView, BoxHoldsTheCylinder) {
  const CameraView view = view_at(0, 0);
  const auto box = view.box_of({11, 2, 3}, 4, 2);
  ASSERT_TRUE(box);
  // Top and bottom at the near rim, 9 m away; the sides where a line of sight touches it.
  EXPECT_NEAR(box->bottom - box->top, 910 * 4 / 9.0, 1e-6);
  EXPECT_NEAR(box->right - box->left, 2 * 900 / std::sqrt(99), 1.0);
  EXPECT_NEAR(box->left + box->right, 2 * 959.5, 1e-6);
  EXPECT_FALSE(view.box_of({1.5, 2, 3}, 4, 2));  // around the camera
  const auto point = view.box_of({11, 2, 3}, 0, 0);
  EXPECT_EQ(point->left, point->right);
  EXPECT_EQ(point->top, point->bottom);
}

}  // namespace
}  // namespace lapwing
