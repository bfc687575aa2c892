// SPDX-License-Identifier: Apache-2.0
// Regions in voxels against the region itself, voxel by voxel.
#include "framework/map/region_voxels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

std::vector<RegionPrism> two_prisms() {
  return {{.name = "elbow",
           .outline = {{-3.1, -2}, {6.3, -2.2}, {6, 1.5}, {1, 1.4}, {0.7, 7}, {-3, 6.6}},
           .holes = {{{-2, -1}, {0, -1}, {-1, 1}}},
           .low = -0.3,
           .high = 3.2},
          {.name = "mast",
           .outline = {{4, -1}, {9, -1}, {9, 0.8}, {4, 0.8}},
           .holes = {},
           .low = 2,
           .high = 6.1,
           .weight = 2.5}};
}

TEST(RegionVoxels, WeighEveryVoxelAsTheRegionWeighsItsCentre) {
  for (const double edge : {0.2, 0.37}) {
    const VoxelGrid grid(edge);
    for (const InterestRegion& region :
         {InterestRegion(two_prisms()),
          InterestRegion(
              Eigen::AlignedBox3d(Eigen::Vector3d(-3.05, -2, 0), Eigen::Vector3d(6, 4, 2.9)))}) {
      const RegionVoxels voxels(region, grid);
      double sum = 0;
      const Eigen::Vector3d around = Eigen::Vector3d::Constant(3 * edge);
      const VoxelKey low = grid.key(region.bounds().min() - around),
                     high = grid.key(region.bounds().max() + around);
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x) {
            const VoxelKey key{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                               static_cast<std::uint16_t>(z)};
            ASSERT_EQ(voxels.weight(key), region.weight(grid.center(key)));
            ASSERT_EQ(voxels.contains(key), region.contains(grid.center(key)));
            sum += voxels.weight(key);
          }
      EXPECT_GT(sum, 1000);
    }
  }
}

TEST(RegionVoxels, WhatHoldsNoVoxelIsRefusedByName) {
  const auto refused = [](std::vector<RegionPrism> prisms) -> std::string {
    try {
      const RegionVoxels voxels(InterestRegion(std::move(prisms)), VoxelGrid(0.5));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refused(two_prisms()), "accepted");
  auto narrow = two_prisms();
  narrow[1].outline = {{4, 0.3}, {9, 0.3}, {9, 0.4}};
  EXPECT_THAT(refused(narrow), HasSubstr("region 'mast' holds the middle of no voxel"));
  auto flat = two_prisms();
  flat[1].low = 2.3, flat[1].high = 2.4;
  EXPECT_THAT(refused(flat), HasSubstr("region 'mast'"));
  auto far = two_prisms();
  for (auto& corner : far[1].outline) corner.x() += 5e5;
  EXPECT_THAT(refused(far), HasSubstr("too far"));
  EXPECT_THROW(RegionVoxels(InterestRegion(), VoxelGrid(0.5)), InputError);
}

}  // namespace
}  // namespace lapwing
