// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "framework/core/error.h"
#include "framework/geometry/depth_camera.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/stereo_depth.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr Pinhole kCamera{160, 120, 80, 80, 79.5, 59.5};

// A wall at x = 10 and ground at z = 0.
MeshScene wall_and_ground() {
  MeshBuilder builder;
  builder.quad({-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0});
  builder.box({10, -50, 0}, {11, 50, 20});
  return MeshScene(builder.take());
}

TEST(DepthCamera, MeasuresAlongTheAxis) {
  const MeshScene scene = wall_and_ground();
  // Straight at the wall, 5 m up: above the horizon all of it is 10 m deep, not farther at the
  // edges.
  const Pose camera = camera_pose({0, 0, 5}, 0, 0);
  const DepthImage image = render_depth(scene, camera, kCamera, 30, 1);
  for (int x = 0; x < 160; x += 7) {
    EXPECT_NEAR(image.at(x, 40), 10, 1e-5) << x;
  }
  // Below, the ground: depth z of a ray that falls y / z per metre is 5 z / y.
  for (int y = 110; y < 120; ++y) EXPECT_NEAR(image.at(80, y), 5 * 80 / (y - 59.5), 1e-4) << y;
  // Turned by 180 degrees there is no wall, and beyond the range nothing at all.
  const DepthImage back =
      render_depth(scene, camera_pose({0, 0, 5}, std::numbers::pi, 0), kCamera, 30, 1);
  EXPECT_EQ(back.at(80, 40), std::numeric_limits<float>::infinity());
  EXPECT_EQ(render_depth(scene, camera, kCamera, 9.9, 1).at(80, 40),
            std::numeric_limits<float>::infinity());
  EXPECT_NEAR(render_depth(scene, camera, kCamera, 10.001, 1).at(0, 40), 10, 1e-5);
}

TEST(DepthCamera, PosesAreThoseOfAGimballedCamera) {
  const Pose down = camera_pose({1, 2, 3}, 0, -std::numbers::pi / 2);
  EXPECT_LT((down.orientation * Vector3d(0, 0, 1) - Vector3d(0, 0, -1)).norm(), 1e-12);
  const Pose north = camera_pose({0, 0, 0}, std::numbers::pi / 2, 0.3);
  EXPECT_LT((north.orientation * Vector3d(1, 0, 0) - Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR((north.orientation * Vector3d(0, 0, 1)).z(), std::sin(0.3), 1e-12);
}

TEST(DepthCamera, ViewsSayWhichTriangleAndWhichWayItFaces) {
  const MeshScene scene = wall_and_ground();
  const MeshView view = render_view(scene, camera_pose({0, 0, 5}, 0, 0), kCamera, 30, 1);
  const auto at = [](int x, int y) { return static_cast<std::size_t>(y * 160 + x); };
  EXPECT_LT((view.normals[at(80, 40)] - Eigen::Vector3f(-1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((view.normals[at(80, 115)] - Eigen::Vector3f(0, 0, 1)).norm(), 1e-6);
  EXPECT_LT(view.triangles[at(80, 115)], 2);
  EXPECT_GE(view.triangles[at(80, 40)], 2);
  // Over the wall is sky: 15 m up at 10 m is pixel -60, so from up close.
  const MeshView up = render_view(scene, camera_pose({0, 0, 5}, 0, 1.2), kCamera, 30, 1);
  EXPECT_EQ(up.triangles[at(80, 10)], -1);
  EXPECT_EQ(up.normals[at(80, 10)], Eigen::Vector3f::Zero());
  EXPECT_EQ(render_depth(scene, camera_pose({0, 0, 5}, 0, 0), kCamera, 30, 1).depth,
            view.depth.depth);
}

TEST(DepthCamera, ThreadsChangeNothing) {
  const MeshScene scene = wall_and_ground();
  const Pose camera = camera_pose({1, 2, 5}, 0.3, -0.2);
  EXPECT_EQ(render_depth(scene, camera, kCamera, 30, 1).depth,
            render_depth(scene, camera, kCamera, 30, 2).depth);
  EXPECT_EQ(render_textured(scene, camera, kCamera, 30, 1).pixels,
            render_textured(scene, camera, kCamera, 30, 2).pixels);
}

TEST(DepthCamera, RefusesCamerasThatSeeNothing) {
  const MeshScene scene = wall_and_ground();
  Pinhole none = kCamera;
  none.width = 0;
  EXPECT_THROW(render_depth(scene, {}, none, 30, 1), InputError);
  Pinhole flat = kCamera;
  flat.focal_y = 0;
  EXPECT_THROW(render_depth(scene, {}, flat, 30, 1), InputError);
  EXPECT_THROW(render_depth(scene, {}, kCamera, 0, 1), InputError);
  EXPECT_THROW(render_depth(scene, {}, kCamera, std::nan(""), 1), InputError);
}

TEST(DepthNoise, HasTheShareAndTheSpreadAskedFor) {
  DepthImage image{{400, 300, 100, 100, 199.5, 149.5}, std::vector<float>(120000, 10.f)};
  for (std::size_t i = 0; i < 40000; ++i) image.depth[i] = std::numeric_limits<float>::infinity();
  add_noise(image, {.dropped = 0.4, .sigma = 0.5}, 7);
  double dropped = 0, sum = 0, squares = 0, far = 0, count = 0;
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const double d = static_cast<double>(image.depth[i]);
    if (d == 0) {
      ++dropped;
    } else if (std::isinf(d)) {
      ++far;
      EXPECT_LT(i, 40000u);
    } else {
      ++count, sum += d, squares += (d - 10) * (d - 10);
    }
  }
  EXPECT_NEAR(dropped / 120000, 0.4, 0.005);
  EXPECT_NEAR(far / 40000, 0.6, 0.01);
  EXPECT_NEAR(sum / count, 10, 0.01);
  EXPECT_NEAR(std::sqrt(squares / count), 0.5, 0.01);
}

TEST(DepthNoise, IsSeededAndBounded) {
  const DepthImage ideal{{40, 30, 10, 10, 19.5, 14.5}, std::vector<float>(1200, 0.5f)};
  DepthImage one = ideal, again = ideal, other = ideal, none = ideal, all = ideal;
  add_noise(one, {.dropped = 0.4, .sigma = 1}, 1);
  add_noise(again, {.dropped = 0.4, .sigma = 1}, 1);
  add_noise(other, {.dropped = 0.4, .sigma = 1}, 2);
  EXPECT_EQ(one.depth, again.depth);
  EXPECT_NE(one.depth, other.depth);
  for (const float d : one.depth) EXPECT_GE(d, 0);
  add_noise(none, {.dropped = 0, .sigma = 0}, 1);
  EXPECT_EQ(none.depth, ideal.depth);
  add_noise(all, {.dropped = 1, .sigma = 0}, 1);
  EXPECT_EQ(all.depth, std::vector<float>(1200, 0.f));
  EXPECT_THROW(add_noise(one, {.dropped = 1.1, .sigma = 0}, 1), InputError);
  EXPECT_THROW(add_noise(one, {.dropped = 0, .sigma = -1}, 1), InputError);
}

TEST(StereoDepth, FindsWallAndGround) {
  const MeshScene scene = wall_and_ground();
  const Pinhole camera{320, 240, 160, 160, 159.5, 119.5};
  const Pose pose = camera_pose({0, 0, 5}, 0.1, -0.1);
  const DepthImage truth = render_depth(scene, pose, camera, 20, 2);
  const DepthImage stereo = stereo_depth(scene, pose, camera, 20, {}, 2);
  int found = 0, right = 0, there = 0;
  for (std::size_t i = 0; i < truth.depth.size(); ++i) {
    if (std::isfinite(truth.depth[i])) ++there;
    if (stereo.depth[i] == 0 || std::isinf(stereo.depth[i]) || !std::isfinite(truth.depth[i]))
      continue;
    ++found;
    // Half a pixel of disparity.
    const double d = static_cast<double>(truth.depth[i]);
    if (std::abs(static_cast<double>(stereo.depth[i]) - d) < 0.5 * d * d / 80) ++right;
  }
  EXPECT_GT(found, 0.85 * there);
  EXPECT_GT(right, 0.95 * found);
}

// What is measured beyond the range is free up to it: ground far away, and clouds.
TEST(StereoDepth, FindsNothingWithinRangeInTheSkyAndFarAway) {
  const MeshScene scene = wall_and_ground();
  const Pose pose = camera_pose({0, 0, 5}, EIGEN_PI, -0.1);  // away from the wall
  const DepthImage truth = render_depth(scene, pose, kCamera, 200, 2);
  const DepthImage stereo = stereo_depth(scene, pose, kCamera, 20, {}, 2);
  int sky = 0, open = 0, near_sky = 0, far = 0, far_open = 0;
  for (std::size_t i = 0; i < truth.depth.size(); ++i) {
    const bool nothing = std::isinf(stereo.depth[i]);
    if (std::isinf(truth.depth[i])) {
      ++sky;
      open += nothing;
      near_sky += !nothing && stereo.depth[i] > 0;
    } else if (truth.depth[i] > 30) {
      ++far;
      far_open += nothing;
    }
  }
  ASSERT_GT(sky, 1000);
  ASSERT_GT(far, 200);
  EXPECT_GT(open, 0.8 * sky);
  EXPECT_LT(near_sky, 0.05 * sky);
  EXPECT_GT(far_open, 0.7 * far);
}

TEST(StereoDepth, RefusesWhatItCannotMatch) {
  const GreyPicture picture{160, 120, std::vector<std::uint8_t>(160 * 120, 100)};
  GreyPicture small = picture;
  small.height = 119;
  EXPECT_THROW(match_stereo(picture, small, kCamera, {}), InputError);
  EXPECT_THROW(match_stereo(picture, picture, kCamera, {.baseline = 0}), InputError);
  EXPECT_THROW(match_stereo(picture, picture, kCamera, {.nearest = 0.1}), InputError);
  EXPECT_THROW(match_stereo(picture, picture, kCamera, {.block = 4}), InputError);
  // Without texture there is nothing to match.
  for (const float d : match_stereo(picture, picture, kCamera, {}).depth) EXPECT_EQ(d, 0);
}

}  // namespace
}  // namespace lapwing
