// SPDX-License-Identifier: Apache-2.0
// The voxels along a ray, in one arithmetic for every backend.
//
// The n-th crossing of a face along an axis is at distance `first + n * spacing`, computed afresh
// and never summed up, so that a walk that skips a cube of voxels arrives exactly where one that
// takes every step does. Crossings at one distance are made z before y before x.
#pragma once

#include <cmath>

#include "framework/map/map.h"

namespace lapwing {

struct RayWalk {
  // A ray that moves less along an axis stays in its layer: a millionth of a voxel off at the end.
  static constexpr double kLevel = 1e-12;
  static constexpr double kNever = 1e300;  // m

  int cell[3];         // where the ray is; leaves 0 to 65535 where it leaves every map
  int step[3];         // -1, 0, 1
  double entered = 0;  // m along the ray to the face through which it came

  // `origin_W` inside the grid, `direction` a unit vector.
  RayWalk(const VoxelGrid& grid, const Eigen::Vector3d& origin_W,
          const Eigen::Vector3d& direction) {
    for (int i = 0; i < 3; ++i) {
      const double d = direction[i];
      cell[i] = start_[i] = grid.index(origin_W[i]);
      step[i] = d > kLevel ? 1 : d < -kLevel ? -1 : 0;
      if (step[i] == 0) {
        first_[i] = kNever;
        spacing_[i] = 0;
        continue;
      }
      const double per_metre = 1 / d;
      first_[i] = (grid.face(cell[i] + (step[i] > 0)) - origin_W[i]) * per_metre;
      spacing_[i] = grid.resolution() * std::abs(per_metre);
    }
  }

  bool inside() const {
    return static_cast<unsigned>(cell[0] | cell[1] | cell[2]) < static_cast<unsigned>(kKeyCount);
  }
  VoxelKey key() const {
    return {static_cast<std::uint16_t>(cell[0]), static_cast<std::uint16_t>(cell[1]),
            static_cast<std::uint16_t>(cell[2])};
  }

  // To the next voxel.
  void advance() {
    const double t[3] = {crossing(0, made(0)), crossing(1, made(1)), crossing(2, made(2))};
    const int axis = earliest(t);
    cell[axis] += step[axis];
    entered = t[axis];
  }

 private:
  int made(int i) const { return (cell[i] - start_[i]) * step[i]; }
  double crossing(int i, int n) const { return first_[i] + n * spacing_[i]; }

  static int earliest(const double t[3]) {
    if (t[0] < t[1]) return t[0] < t[2] ? 0 : 2;
    return t[1] < t[2] ? 1 : 2;
  }

  int start_[3];
  double first_[3], spacing_[3];
};

// The hit of a ray that met nothing within its range, and of one that left the largest map.
inline MapRayHit nothing_within(const MapRay& ray) {
  return {{}, VoxelState::free, static_cast<float>(ray.range)};
}
inline MapRayHit end_of_map(const RayWalk& walk) {
  const auto last = [&](int i) {
    return static_cast<std::uint16_t>(std::clamp(walk.cell[i], 0, kKeyCount - 1));
  };
  return {{last(0), last(1), last(2)}, VoxelState::unknown, static_cast<float>(walk.entered)};
}

}  // namespace lapwing
