// SPDX-License-Identifier: Apache-2.0
// A region of interest in the voxels of a map: quick answers for single voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/geometry/interest_region.h"
#include "framework/map/voxel.h"

namespace lapwing {

// A voxel belongs to a region when its centre does. Immutable, thread-safe.
class RegionVoxels {
 public:
  // InputError: an empty region, one beyond the largest map, one of prisms with more than 2^28
  // columns of voxels, a region or a prism that holds the centre of no voxel.
  RegionVoxels(const InterestRegion& region, const VoxelGrid& grid);

  const VoxelBox& box() const { return box_; }  // around all voxels of the region
  bool contains(const VoxelKey& key) const { return weight(key) > 0; }
  double weight(const VoxelKey& key) const;

 private:
  struct Band {  // of voxels, both ends included
    int low = 0, high = 0;
    double weight = 1;
  };
  std::size_t column(int x, int y) const {
    return static_cast<std::size_t>(y - box_.lower.y) *
               static_cast<std::size_t>(box_.upper.x - box_.lower.x + 1) +
           static_cast<std::size_t>(x - box_.lower.x);
  }
  void add_columns(const InterestRegion& region, const VoxelGrid& grid);

  VoxelBox box_;
  // Of prisms: the number of the set of bands over each column. The first set is empty.
  std::vector<std::uint32_t> columns_;
  std::vector<std::vector<Band>> sets_;
};

}  // namespace lapwing
