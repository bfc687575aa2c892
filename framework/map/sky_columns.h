// SPDX-License-Identifier: Apache-2.0
// What a surface says of the space around it: what the open sky or a scanner sees is free.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "framework/map/voxel.h"

namespace lapwing {

// Columns of voxels and where each of them ends upwards.
class SkyColumns {
 public:
  static constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::min();

  // The columns from (x, y) on, `width` along x and `depth` along y; nothing is known of them.
  // InputError for more than 2^28 of them.
  SkyColumns(int x, int y, int width, int depth);
  // Those of the voxels, each with its highest one. Empty without voxels.
  static SkyColumns over(std::span<const VoxelKey> occupied);

  int x() const { return x_; }
  int y() const { return y_; }
  int width() const { return width_; }
  int depth() const { return depth_; }
  // The highest voxel that is not open sky; kUnknown where nothing is known, and outside.
  std::int32_t top(int x, int y) const;
  void set_top(int x, int y, std::int32_t top);

  // Cubes of the voxels above the tops up to the voxel `ceiling`, as free leaves.
  std::vector<VoxelLeaf> free_above(int ceiling) const;
  // Cubes of the voxels from `floor` up to the tops, as occupied leaves.
  std::vector<VoxelLeaf> solid_below(int floor) const;

 private:
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y - y_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x - x_);
  }

  int x_ = 0, y_ = 0, width_ = 0, depth_ = 0;
  std::vector<std::int32_t> tops_;  // x fastest
};

// Voxels that straight lines from a scanner to the middles of `measured` voxels pass before they
// meet one of `occupied`, each once, in the order of keys. Of several scanners the nearest one
// counts for each voxel. Voxels farther than `range` (m) from it give none. `scanners` in metres,
// world. InputError for a scanner outside of the largest map, or a box of more than 2^34 voxels.
std::vector<VoxelKey> free_from_scanners(std::span<const VoxelKey> measured,
                                         std::span<const VoxelKey> occupied,
                                         std::span<const Eigen::Vector3d> scanners,
                                         const VoxelGrid& grid, double range);

}  // namespace lapwing
