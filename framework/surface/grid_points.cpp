// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/grid_points.h"

#include <algorithm>

#include "framework/core/error.h"

namespace lapwing {

void check_reconstruction(const ReconstructionSettings& s) {
  const auto sound = [](double number) { return std::isfinite(number) && number > 0; };
  if (s.region.isEmpty()) throw InputError("reconstruction: the region is empty");
  if (!sound(s.grid) || !sound(s.near) || !sound(s.range)) {
    throw InputError("reconstruction: grid, near and range must be above 0 m");
  }
  const double parts = s.near / s.grid;
  if (std::abs(parts - std::round(parts)) > 1e-6 || parts < 0.5) {
    throw InputError("reconstruction: near must be a whole multiple of grid");
  }
  if (s.images < 1) throw InputError("reconstruction: at least 1 image must agree");
  if (!sound(s.incidence) || s.incidence > 1.5708) {
    throw InputError("reconstruction: incidence must be above 0 and at most 90 degrees");
  }
  const double reach = s.region.min().cwiseAbs().cwiseMax(s.region.max().cwiseAbs()).maxCoeff();
  if (!((reach + 1) / std::min(s.grid, s.near) < kMostGridPlaces)) {
    throw InputError("reconstruction: the region has more than 2^20 places of the grid to an edge");
  }
}

void sort_by_key(std::vector<KeyedPoint>& placed) {
  std::sort(placed.begin(), placed.end(),
            [](const KeyedPoint& a, const KeyedPoint& b) { return a.key < b.key; });
}

GridPoints in_order(std::vector<KeyedPoint> placed) {
  sort_by_key(placed);
  GridPoints points;
  points.reserve(placed.size());
  for (const KeyedPoint& p : placed) points.push_back(p.point);
  return points;
}

}  // namespace lapwing
