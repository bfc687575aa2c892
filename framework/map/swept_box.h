// SPDX-License-Identifier: Apache-2.0
// Which voxels a box meets while it moves in a straight line.
#pragma once

#include <algorithm>
#include <optional>

#include "framework/map/voxel.h"

namespace lapwing {

// Share of a voxel within which things touch rather than overlap: touching is free.
inline constexpr double kTouching = 1e-6;

// The inside of a box with half edges `half` whose middle moves from `from` to `to`, in a grid.
// Faces that only touch do not meet. World frame, metres.
class SweptBox {
 public:
  SweptBox(const VoxelGrid& grid, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
           const Eigen::Vector3d& half)
      : grid_(&grid), from_(from) {
    for (int i = 0; i < 3; ++i) {
      // A flat box still is somewhere.
      half_[i] = std::max(half[i] - kTouching * grid.resolution(), 0.0);
      const double d = to[i] - from[i];
      still_[i] = std::abs(d) < kTouching * grid.resolution();
      inverse_[i] = still_[i] ? 0 : 1 / d;
      lower[i] = grid.index(std::min(from[i], to[i]) - half_[i]);
      upper[i] = grid.index(std::max(from[i], to[i]) + half_[i]);
    }
  }

  // Voxels beyond these are not met; may lie outside 0 to 65535.
  int lower[3], upper[3];

  // Whether it meets the cube of (2^level)^3 voxels whose lowest voxel is given. Never true for a
  // part of a cube for which it is false.
  bool meets(const int lowest[3], int level) const {
    double enters = 0, leaves = 1;
    for (int i = 0; i < 3; ++i) {
      const double low = grid_->face(lowest[i]) - half_[i];
      const double high = grid_->face(lowest[i] + (1 << level)) + half_[i];
      if (still_[i]) {
        if (upper[i] < lowest[i] || lower[i] >= lowest[i] + (1 << level)) return false;
        continue;
      }
      double a = (low - from_[i]) * inverse_[i], b = (high - from_[i]) * inverse_[i];
      if (a > b) std::swap(a, b);
      enters = std::max(enters, a);
      leaves = std::min(leaves, b);
    }
    return enters <= leaves;
  }

 private:
  const VoxelGrid* grid_;
  Eigen::Vector3d from_;
  double half_[3], inverse_[3];
  bool still_[3];
};

}  // namespace lapwing
