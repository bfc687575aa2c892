// SPDX-License-Identifier: Apache-2.0
// Which voxels of a block lie in balls that fit among marked ones: a morphological opening.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace lapwing {

// Voxels in a box, x fastest, then y. One byte each.
struct VoxelBlock {
  std::array<int, 3> size{};
  std::vector<std::uint8_t> marked;  // 1 or 0

  std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
  std::size_t place(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(x);
  }
};

// Leaves those marked that lie in a ball of marked voxels: one that has no middle of another voxel
// within `radius` of its own middle, which is a voxel's. `radius` has one number for each
// voxel, for balls about it, in voxels, at least 0. What lies outside the block is taken to be
// marked; the result is as in a larger block for all that is two of the largest radii from its
// faces. (Erosion and dilation by distances; Felzenszwalb and Huttenlocher, 2012, for both as one
// transform.)
void keep_balls(VoxelBlock& block, const std::vector<float>& radius);

// Of every voxel of the block, the squared distance of its middle from that of the nearest voxel
// which is not marked, in voxels; 1e12 where none lies within `reach` voxels along each axis.
std::vector<float> squared_rooms(const VoxelBlock& block, int reach);

}  // namespace lapwing
