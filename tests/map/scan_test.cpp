// SPDX-License-Identifier: Apache-2.0
#include "framework/map/scan.h"

#include "framework/map/ray_walk.h"
#include "framework/map/swept_box.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

// 4 x 2 pixels, looking along +x of the world from (1, 2, 3), image level.
PosedDepthImage image() {
  PosedDepthImage measured;
  measured.image.pinhole = {4, 2, 2, 2, 1, 0};
  measured.image.depth.assign(8, 5.0f);
  measured.camera.position = {1, 2, 3};
  Eigen::Matrix3d R_WC;
  R_WC << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // right is -y, down is -z, forward is +x
  measured.camera.orientation = Eigen::Quaterniond(R_WC);
  return measured;
}

std::vector<Eigen::Vector3f> points_of(const PosedDepthImage& measured, int step, double range) {
  std::vector<Eigen::Vector3f> points;
  scan_points(measured, step, range, 0.1, points);
  return points;
}

TEST(Scan, DepthIsAlongTheOpticalAxis) {
  const auto points = points_of(image(), 1, INFINITY);
  ASSERT_EQ(points.size(), 8u);
  EXPECT_LT((points[1] - Eigen::Vector3f(6, 2, 3)).norm(), 1e-6);     // the principal point
  EXPECT_LT((points[3] - Eigen::Vector3f(6, -3, 3)).norm(), 1e-6);    // two pixels to the right
  EXPECT_LT((points[5] - Eigen::Vector3f(6, 2, 0.5f)).norm(), 1e-6);  // one down
}

TEST(Scan, PixelsWithoutMeasurementAndStepsAreLeftOut) {
  PosedDepthImage measured = image();
  measured.image.depth[0] = 0;
  EXPECT_EQ(points_of(measured, 1, INFINITY).size(), 7u);
  EXPECT_EQ(points_of(measured, 2, INFINITY).size(), 1u);  // the second of row 0 was left out
  EXPECT_EQ(points_of(image(), 2, INFINITY).size(), 2u);
}

TEST(Scan, APixelWithoutAHitLiesJustBeyondTheRange) {
  PosedDepthImage measured = image();
  measured.image.depth.assign(8, INFINITY);
  for (const Eigen::Vector3f& p : points_of(measured, 1, 30)) {
    const float distance = (p - Eigen::Vector3f(1, 2, 3)).norm();
    EXPECT_GT(distance, 30.17f);
    EXPECT_LT(distance, 30.25f);
  }
  EXPECT_THROW(points_of(measured, 1, INFINITY), InputError);
}

TEST(Scan, BadImagesAreRefused) {
  const auto refused = [](const std::function<void(PosedDepthImage&)>& spoil) {
    PosedDepthImage measured = image();
    spoil(measured);
    EXPECT_THROW(points_of(measured, 1, 30), InputError);
  };
  refused([](PosedDepthImage& m) { m.image.depth.pop_back(); });
  refused([](PosedDepthImage& m) { m.image.depth[3] = -1; });
  refused([](PosedDepthImage& m) { m.image.depth[3] = NAN; });
  refused([](PosedDepthImage& m) { m.image.pinhole.focal_x = 0; });
  refused([](PosedDepthImage& m) { m.image.pinhole.width = 0; });
  refused([](PosedDepthImage& m) { m.image.pinhole.principal_y = NAN; });
  refused([](PosedDepthImage& m) { m.camera.orientation.coeffs() *= 1.1; });
  refused([](PosedDepthImage& m) { m.camera.orientation.coeffs().setZero(); });
  refused([](PosedDepthImage& m) { m.camera.position.x() = INFINITY; });
}

TEST(Scan, ThreeImagesMakeAVoxelFreeAndTwoOccupied) {
  SmallMap map(0.5);
  const std::vector<Eigen::Vector3f> points{{3.2f, 0.2f, 0.2f}};
  const VoxelKey passed = map.grid().key({1.2, 0.2, 0.2}), end = map.grid().key({3.2, 0.2, 0.2});
  for (int image = 1; image <= 3; ++image) {
    map.integrate(points, {0.2f, 0.2f, 0.2f});
    EXPECT_EQ(map.read(passed).state == VoxelState::free, image >= 3);
    EXPECT_EQ(map.read(end).state == VoxelState::occupied, image >= 2);
  }
  EXPECT_NEAR(map.read(passed).log_odds, 3 * std::log(0.4 / 0.6), 1e-6);
}

TEST(Settings, WhatContradictsIsNamed) {
  Value value = Value::map();
  value.set("clamp_min", 0.2);
  value.set("free_below", 0.2);
  try {
    map_settings(check(map_parameters(), value));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("clamp_min"), std::string::npos) << error.what();
  }
  for (const double resolution : {0.0, -0.1, double(NAN)}) {
    Value bad = Value::map();
    bad.set("resolution", resolution);
    EXPECT_THROW(check(map_parameters(), bad), InputError) << resolution;
  }
}

TEST(RayWalk, PassesFacesInOrder) {
  const VoxelGrid grid(0.5);
  RayWalk walk(grid, {0.25, 0.25, 0.25}, Eigen::Vector3d(1, 0.5, 0).normalized());
  std::string steps;
  for (int k = 0; k < 6; ++k) {
    const int before[3] = {walk.cell[0], walk.cell[1], walk.cell[2]};
    walk.advance();
    for (int i = 0; i < 3; ++i)
      if (walk.cell[i] != before[i]) steps += "xyz"[i];
  }
  EXPECT_EQ(steps, "xyxxyx");  // at 0.25, 0.5, 0.75, 1.25, 1.5, 1.75 m of x: ties are y before x
  RayWalk corner(grid, {0.25, 0.25, 0.25}, Eigen::Vector3d(1, 1, 1).normalized());
  corner.advance();
  EXPECT_EQ(corner.cell[2], 32769);  // at one distance z before y before x
  EXPECT_EQ(corner.cell[1], 32768);
}

TEST(Morton, CubesShareTheirNumber) {
  const VoxelKey a{12, 5, 8}, b{15, 4, 11};
  EXPECT_EQ(a.morton() >> 6, b.morton() >> 6);
  EXPECT_EQ((VoxelKey{1, 0, 0}.morton()), 1u);
  EXPECT_EQ((VoxelKey{0, 1, 0}.morton()), 2u);
  EXPECT_EQ((VoxelKey{0, 0, 1}.morton()), 4u);
  EXPECT_EQ((VoxelKey{65535, 65535, 65535}.morton()), (std::uint64_t{1} << 48) - 1);
}

}  // namespace
}  // namespace lapwing
