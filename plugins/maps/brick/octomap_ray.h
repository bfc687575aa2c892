// SPDX-License-Identifier: Apache-2.0
// How OctoMap starts a ray through its keys, in its own precision: points and directions in single,
// distances in double. Compile without fused multiply-add.
#pragma once

#include <cmath>
#include <limits>

#include "framework/map/voxel.h"

namespace lapwing::brick_map {

// Crossings of faces along axis i come at `t[i]`, then every `spacing[i]` (m), summed up.
struct RayStart {
  double t[3], spacing[3];
  double length;  // m
  int step[3], end[3];
};

// All rays of a scan start at one place.
class RayOrigin {
 public:
  RayOrigin(const VoxelGrid& grid, const Eigen::Vector3f& origin_W)
      : grid_(grid), origin_(origin_W) {
    for (int i = 0; i < 3; ++i) {
      cell_[i] = grid.index(origin_W[i]);
      for (const int side : {0, 1}) {
        const double step = side ? 1 : -1;
        double border = grid.center(cell_[i]);
        border += static_cast<float>(step * grid.resolution() * 0.5);
        to_border_[side][i] = border - origin_W[i];
      }
    }
  }

  const int* cell() const { return cell_; }

  // Whether a point lies in the first voxel.
  bool holds(const Eigen::Vector3f& p_W) const {
    return grid_.index(p_W.x()) == cell_[0] && grid_.index(p_W.y()) == cell_[1] &&
           grid_.index(p_W.z()) == cell_[2];
  }

  // False when the end lies in the first voxel, so that there is nothing to pass.
  __attribute__((always_inline)) bool start(const Eigen::Vector3f& end_W, RayStart& ray) const {
    for (int i = 0; i < 3; ++i) ray.end[i] = grid_.index(end_W[i]);
    if (ray.end[0] == cell_[0] && ray.end[1] == cell_[1] && ray.end[2] == cell_[2]) return false;
    float x = end_W.x() - origin_.x(), y = end_W.y() - origin_.y(), z = end_W.z() - origin_.z();
    const float squared = x * x + y * y + z * z;
    const float length = static_cast<float>(std::sqrt(static_cast<double>(squared)));
    ray.length = length;
    const float direction[3] = {x / length, y / length, z / length};
    for (int i = 0; i < 3; ++i) {
      const float d = direction[i];
      ray.step[i] = (d > 0) - (d < 0);
      if (ray.step[i] == 0) {
        ray.t[i] = ray.spacing[i] = std::numeric_limits<double>::max();
        continue;
      }
      ray.t[i] = to_border_[d > 0][i] / d;
      ray.spacing[i] = grid_.resolution() / std::abs(d);
    }
    return true;
  }

 private:
  VoxelGrid grid_;
  Eigen::Vector3f origin_;
  int cell_[3];
  double to_border_[2][3];  // m, towards lower and higher coordinates
};

}  // namespace lapwing::brick_map
