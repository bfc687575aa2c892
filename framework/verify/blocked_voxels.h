// SPDX-License-Identifier: Apache-2.0
// What a map file closes to flight, for the verifier: every voxel that is not known to be free.
//
// Internal to this room. World frame, metres.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "framework/map/map_file.h"

namespace lapwing {

class BlockedVoxels {
 public:
  // Of the voxels that `box` meets; everything beyond them counts as blocked. Free is less probably
  // occupied than 0.25. InputError: a map of two states, which cannot say what it does not know; a
  // box of more than 2^31 voxels.
  BlockedVoxels(const MapFile& file, const Eigen::AlignedBox3d& box);

  // m to the nearest blocked voxel's cube, 0 within it; at most `farthest`. Exact.
  double distance(const Eigen::Vector3d& p_W, double farthest) const;

  // Where a way straight from one place to another comes nearest to a blocked voxel's cube: the
  // distance, at most `farthest`, and the share of the way. Exact.
  struct Nearest {
    double distance, share;
  };
  Nearest nearest(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double farthest) const;

  const VoxelGrid& grid() const { return grid_; }
  // Along each axis, in the grid's counting: the first voxel that is held, and how many.
  int first(int axis) const { return low_[axis]; }
  int count(int axis) const { return size_[axis]; }
  // Counted from the first one; false for what is not held.
  bool free(int x, int y, int z) const {
    if (x < 0 || y < 0 || z < 0 || x >= size_[0] || y >= size_[1] || z >= size_[2]) return false;
    const std::size_t bit = (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) +
                             static_cast<std::size_t>(y)) *
                                static_cast<std::size_t>(size_[0]) +
                            static_cast<std::size_t>(x);
    return free_[bit / 64] >> (bit % 64) & 1;
  }

 private:
  VoxelGrid grid_;
  int low_[3], size_[3];
  std::vector<std::uint64_t> free_;  // a bit a voxel, x fastest
};

}  // namespace lapwing
