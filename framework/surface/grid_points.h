// SPDX-License-Identifier: Apache-2.0
// Points averaged on a grid, and the cubes in which they are compared. Internal to the room.
#pragma once

#include <cmath>
#include <vector>

#include "framework/surface/grid_table.h"
#include "framework/surface/reconstruction.h"

namespace lapwing {

inline constexpr double kMostGridPlaces = 1 << 20;  // along an edge of the region
// The grids do not begin at round numbers of metres, where walls and floors are wont to lie: the
// rounding of a depth would strew one surface over two layers of places.
inline constexpr double kGridShift = 0.3719;  // of the larger one's edge

struct GridPlaces {
  double edge, shift;  // m
  GridKey of(const Eigen::Vector3d& p) const {
    const auto at = [&](double x) {
      return static_cast<std::int64_t>(std::floor((x + shift) / edge));
    };
    return grid_key(at(p.x()), at(p.y()), at(p.z()));
  }
};

inline GridPlaces grid_of(const ReconstructionSettings& s) {
  return {s.grid, kGridShift * s.near};
}
inline GridPlaces cubes_of(const ReconstructionSettings& s) {
  return {s.near, kGridShift * s.near};
}

struct PointSum {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::int64_t count = 0;

  void add(const Eigen::Vector3d& p) {
    sum += p;
    ++count;
  }
  Eigen::Vector3f mean() const { return (sum / static_cast<double>(count)).cast<float>(); }
};

struct KeyedPoint {
  GridKey key;
  Eigen::Vector3f point;
};

void sort_by_key(std::vector<KeyedPoint>& placed);
GridPoints in_order(std::vector<KeyedPoint> placed);

// InputError for settings that make no sense.
void check_reconstruction(const ReconstructionSettings& settings);

}  // namespace lapwing
