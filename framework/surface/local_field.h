// SPDX-License-Identifier: Apache-2.0
// A signed field through points with normals, each place from the points around it: implicit moving
// least squares (Kolluri, "Provably good moving least squares", SODA 2005, eq. 1).
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "framework/surface/point_fusion.h"

namespace lapwing {

class LocalField {
 public:
  // `width`, m: where a point's weight is 1/e of that at its place. All points within `reach`, m,
  // of a place count there. Both above 0; few widths are enough for a reach.
  LocalField(const std::vector<FusedPoint>& points, double width, double reach);

  // m; above 0 on the side of the normals; 1 if no point is near. Thread-safe.
  double value(const Eigen::Vector3d& p) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Eigen::Vector3d& p) const;

  double width_, reach_;
  std::vector<FusedPoint> points_;                   // by cell
  std::vector<std::pair<Cell, std::size_t>> cells_;  // in order, with the first of their points
};

}  // namespace lapwing
