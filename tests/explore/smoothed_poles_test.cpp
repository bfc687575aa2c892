// SPDX-License-Identifier: Apache-2.0
// What smoothing costs a map: thin obstacles before a wall. The figures stand in
// plugins/utilities/learned/EXPERIMENTS.md.
#include <gtest/gtest.h>

#include <set>

#include "tests/explore/explore_fixture.h"

namespace lapwing {
namespace {

constexpr int kPoles = 13, kImages = 40;
constexpr double kWidth = 0.1, kHeight = 5;  // m, of a pole

// Poles 1.5 m apart, 2 m before a wall.
std::shared_ptr<const MeshScene> poles_before_a_wall() {
  TriangleMesh mesh;
  add_quad(mesh, {-5, -25, 0}, {25, 0, 0}, {0, 50, 0});
  add_quad(mesh, {12.1, -25, 0}, {0, 50, 0}, {0, 0, 8});
  for (int k = 0; k < kPoles; ++k) {
    const Eigen::Vector3d foot(10.1, 1.5 * (k - kPoles / 2) + 0.15, 0);
    add_box(mesh, foot, foot + Eigen::Vector3d(kWidth, kWidth, kHeight));
  }
  return std::make_shared<MeshScene>(std::move(mesh), "poles");
}

std::set<VoxelKey> voxels_of_poles(const VoxelGrid& grid) {
  std::set<VoxelKey> keys;
  for (int k = 0; k < kPoles; ++k)
    for (double z = 0.45; z < kHeight; z += 0.1)
      for (const double across : {0.001, 0.5, 0.999})
        for (const double along : {0.001, 0.5, 0.999})
          keys.insert(grid.key(
              {10.1 + along * kWidth, 1.5 * (k - kPoles / 2) + 0.15 + across * kWidth, z}));
  return keys;
}

struct PoleVoxels {
  std::size_t all = 0, free = 0;
};

// After images from 4 to 9 m before the poles, as an exploration maps them.
PoleVoxels mapped(std::optional<DepthNoise> noise, double smooth_to) {
  const auto scene = poles_before_a_wall();
  ViewSensor sensor{.pinhole = {160, 120, 80, 80, 79.5, 59.5}};
  sensor.noise = noise;
  sensor.smooth_to = smooth_to;
  const auto map = YardWorld::new_map();
  for (int k = 0; k < kImages; ++k) {
    const Viewpoint view{
        {1 + 5. * (k % 4) / 3, -9 + 18. * k / (kImages - 1), 2.5}, 0.1 * (k % 5 - 2), -0.1};
    PosedDepthImage image = sensor.measure(*scene, view, static_cast<std::uint64_t>(k), 1);
    sensor.smooth(image, 1);
    map->integrate(image);
  }
  PoleVoxels found;
  for (const VoxelKey& key : voxels_of_poles(map->grid())) {
    ++found.all;
    if (map->read(key).state == VoxelState::free) ++found.free;
  }
  return found;
}

TEST(SmoothedPoles, ManyVanishFromTheMap) {
  const auto noise = [](double sigma) { return DepthNoise{.dropped = 0.4, .sigma = sigma}; };
  const PoleVoxels clear = mapped(std::nullopt, 0);
  std::printf("%zu voxels; free: %zu without noise\n", clear.all, clear.free);
  EXPECT_LT(clear.free, clear.all / 10);
  for (const double sigma : {0.5, 1.}) {
    const PoleVoxels noisy = mapped(noise(sigma), 0), smooth = mapped(noise(sigma), 0.2);
    std::printf("sigma %g m: %zu, smoothed %zu\n", sigma, noisy.free, smooth.free);
    EXPECT_GT(noisy.free, clear.free) << sigma;
    EXPECT_GT(smooth.free, noisy.free) << sigma;
  }
}

}  // namespace
}  // namespace lapwing
