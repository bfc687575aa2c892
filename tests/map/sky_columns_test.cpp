// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/map/sky_columns.h"

namespace lapwing {
namespace {

constexpr int kMiddle = kCenterKey;

VoxelKey column_key(int x, int y, int z) {
  return {static_cast<std::uint16_t>(kMiddle + x), static_cast<std::uint16_t>(kMiddle + y),
          static_cast<std::uint16_t>(kMiddle + z)};
}

// Every voxel of the leaves with its number of leaves.
std::map<VoxelKey, int> voxels_of(const std::vector<VoxelLeaf>& leaves) {
  std::map<VoxelKey, int> voxels;
  for (const VoxelLeaf& leaf : leaves) {
    const int edge = 1 << leaf.level;
    EXPECT_EQ(leaf.key.x % edge + leaf.key.y % edge + leaf.key.z % edge, 0);
    for (int x = 0; x < edge; ++x)
      for (int y = 0; y < edge; ++y)
        for (int z = 0; z < edge; ++z)
          ++voxels[{static_cast<std::uint16_t>(leaf.key.x + x),
                    static_cast<std::uint16_t>(leaf.key.y + y),
                    static_cast<std::uint16_t>(leaf.key.z + z)}];
  }
  return voxels;
}

// Against one voxel at a time, over columns on both sides of a boundary of large cubes.
TEST(SkyColumns, CubesAreTheVoxelsOfEachColumn) {
  Random random(3);
  std::vector<VoxelKey> occupied;
  for (int i = 0; i < 500; ++i)
    occupied.push_back(column_key(static_cast<int>(random.uniform(-9, 20)),
                                  static_cast<int>(random.uniform(-14, 11)),
                                  static_cast<int>(random.uniform(-6, 6))));
  for (int x = 8; x < 16; ++x)  // a level part, for large cubes
    for (int y = -8; y < 0; ++y) occupied.push_back(column_key(x, y, 7));
  const SkyColumns columns = SkyColumns::over(occupied);
  const int floor = kMiddle - 3, ceiling = kMiddle + 17;
  const auto free = voxels_of(columns.free_above(ceiling));
  const auto solid = voxels_of(columns.solid_below(floor));
  std::size_t free_count = 0, solid_count = 0;
  for (int x = kMiddle - 20; x < kMiddle + 30; ++x)
    for (int y = kMiddle - 20; y < kMiddle + 30; ++y) {
      int top = SkyColumns::kUnknown;
      for (const VoxelKey& key : occupied)
        if (key.x == x && key.y == y) top = std::max<int>(top, key.z);
      ASSERT_EQ(columns.top(x, y), top);
      for (int z = kMiddle - 20; z < kMiddle + 30; ++z) {
        const VoxelKey key{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                           static_cast<std::uint16_t>(z)};
        const bool known = top != SkyColumns::kUnknown;
        const bool above = known && z > top && z <= ceiling;
        const bool below = known && z <= top && z >= floor;
        ASSERT_EQ(free.count(key), above) << x << " " << y << " " << z;
        ASSERT_EQ(solid.count(key), below) << x << " " << y << " " << z;
        free_count += above;
        solid_count += below;
      }
    }
  EXPECT_EQ(free.size(), free_count);
  EXPECT_EQ(solid.size(), solid_count);
  for (const auto& [key, times] : free) EXPECT_EQ(times, 1);
  EXPECT_GT(free_count, 1000u);
  EXPECT_GT(solid_count, 100u);
}

TEST(SkyColumns, NothingAndTooMuch) {
  EXPECT_TRUE(SkyColumns::over({}).free_above(kMiddle).empty());
  const SkyColumns empty(kMiddle, kMiddle, 4, 4);
  EXPECT_TRUE(empty.free_above(kMiddle + 5).empty());
  EXPECT_TRUE(empty.solid_below(kMiddle - 5).empty());
  EXPECT_THROW(SkyColumns(0, 0, 1 << 16, 1 << 16), InputError);
}

// A wall at x = 5 with a window, a scanner before it, and points on a wall at x = 9.
TEST(FreeFromScanners, LinesEndAtTheFirstWall) {
  const VoxelGrid grid(1);
  std::vector<VoxelKey> measured, occupied;
  for (int y = -3; y <= 3; ++y)
    for (int z = -3; z <= 3; ++z) {
      if (y != 0 || z != 0) occupied.push_back(column_key(5, y, z));
      measured.push_back(column_key(9, y, z));
    }
  occupied.insert(occupied.end(), measured.begin(), measured.end());
  std::sort(occupied.begin(), occupied.end());
  const std::vector<Eigen::Vector3d> scanners{{0.5, 0.5, 0.5}};
  const auto list = free_from_scanners(measured, occupied, scanners, grid, 100);
  const std::set<VoxelKey> free(list.begin(), list.end());
  EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
  for (int x = 0; x < 9; ++x) EXPECT_TRUE(free.count(column_key(x, 0, 0))) << x;
  EXPECT_FALSE(free.count(column_key(9, 0, 0))) << "the point itself";
  for (const VoxelKey& key : free) {
    EXPECT_FALSE(std::binary_search(occupied.begin(), occupied.end(), key));
    EXPECT_TRUE(key.x < kMiddle + 5 || (key.y == kMiddle && key.z == kMiddle)) << "behind the wall";
  }
  EXPECT_TRUE(free_from_scanners(measured, occupied, scanners, grid, 5).empty()) << "out of range";
  EXPECT_TRUE(free_from_scanners(measured, occupied, {}, grid, 100).empty());
  const std::vector<Eigen::Vector3d> far{{1e6, 0, 0}};
  EXPECT_THROW(free_from_scanners(measured, occupied, far, grid, 100), InputError);
}

}  // namespace
}  // namespace lapwing
