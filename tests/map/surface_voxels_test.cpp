// SPDX-License-Identifier: Apache-2.0
#include "framework/map/surface_voxels.h"

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Triangle = std::array<std::int32_t, 3>;

std::vector<VoxelKey> voxels(const std::vector<Eigen::Vector3d>& corners, double resolution) {
  std::vector<Triangle> triangles;
  for (std::int32_t k = 0; k + 2 < static_cast<std::int32_t>(corners.size()); k += 3)
    triangles.push_back({k, k + 1, k + 2});
  return surface_voxels(corners, triangles, resolution);
}

VoxelKey key(int x, int y, int z) {
  return {static_cast<std::uint16_t>(32768 + x), static_cast<std::uint16_t>(32768 + y),
          static_cast<std::uint16_t>(32768 + z)};
}

TEST(SurfaceVoxels, ATriangleInOneVoxel) {
  const auto found = voxels({{0.1, 0.1, 0.1}, {0.3, 0.1, 0.2}, {0.2, 0.4, 0.3}}, 0.5);
  EXPECT_EQ(found, std::vector<VoxelKey>{key(0, 0, 0)});
}

TEST(SurfaceVoxels, AWallBetweenTwoVoxelsBelongsToOne) {
  // The square x = 0, from 0 to 1 in y and z, exactly on faces of voxels of 0.5 m.
  const auto found = voxels(
      {{0, 0, 0}, {0, 0.99, 0}, {0, 0.99, 0.99}, {0, 0, 0}, {0, 0.99, 0.99}, {0, 0, 0.99}}, 0.5);
  const std::vector<VoxelKey> right{key(0, 0, 0), key(0, 0, 1), key(0, 1, 0), key(0, 1, 1)};
  EXPECT_EQ(found, right);
}

TEST(SurfaceVoxels, ASlantedTriangleMissesTheCornersOfItsBox) {
  // The plane x + y + z = 3 in voxels of 1 m: the corner voxel (0, 0, 0) has x + y + z < 3.
  const auto found = voxels({{3, 0, 0}, {0, 3, 0}, {0, 0, 3}}, 1);
  EXPECT_EQ(std::count(found.begin(), found.end(), key(0, 0, 0)), 1);  // touches (1, 1, 1)
  EXPECT_EQ(std::count(found.begin(), found.end(), key(0, 0, 1)), 1);
  EXPECT_EQ(std::count(found.begin(), found.end(), key(2, 2, 0)), 0);
  EXPECT_EQ(std::count(found.begin(), found.end(), key(1, 1, 1)), 1);  // touches at its corner
  EXPECT_EQ(std::count(found.begin(), found.end(), key(2, 1, 1)), 0);
}

TEST(SurfaceVoxels, HoldEveryPointOfTheSurfaceAndNothingFar) {
  Random random(4);
  for (int turn = 0; turn < 30; ++turn) {
    std::vector<Eigen::Vector3d> corners;
    for (int k = 0; k < 3; ++k)
      corners.push_back({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)});
    const VoxelGrid grid(0.3);
    const auto found = voxels(corners, 0.3);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
    std::vector<VoxelKey> met;
    for (int k = 0; k < 20000; ++k) {
      double a = random.uniform(), b = random.uniform();
      if (a + b > 1) a = 1 - a, b = 1 - b;
      met.push_back(
          grid.key(corners[0] + a * (corners[1] - corners[0]) + b * (corners[2] - corners[0])));
      EXPECT_TRUE(std::binary_search(found.begin(), found.end(), met.back()));
    }
    // Nearly every voxel found is one that a point was met in: others are grazed.
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    EXPECT_GE(met.size(), 0.85 * static_cast<double>(found.size()));
  }
}

TEST(SurfaceVoxels, TrianglesWithoutAreaAndBadInput) {
  EXPECT_EQ(voxels({{0.1, 0.1, 0.1}, {1.1, 0.1, 0.1}, {2.1, 0.1, 0.1}}, 1).size(), 3u);
  EXPECT_EQ(voxels({{0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}}, 1).size(), 1u);
  EXPECT_TRUE(voxels({}, 1).empty());
  EXPECT_THROW(voxels({{0, 0, 0}, {1, 0, NAN}, {0, 1, 0}}, 1), InputError);
  EXPECT_THROW(voxels({{0, 0, 0}, {1, 0, 40000}, {0, 1, 0}}, 1), InputError);
  const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}};
  const std::vector<Triangle> missing{{0, 1, 3}}, good{{0, 1, 2}};
  EXPECT_THROW(surface_voxels(corners, missing, 1), InputError);
  EXPECT_THROW(surface_voxels(corners, good, 1, 100), InputError);
}

}  // namespace
}  // namespace lapwing
