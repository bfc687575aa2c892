// SPDX-License-Identifier: Apache-2.0
// Polygons on the ground.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace lapwing {

// Whether corners bound one area: at least three, no edge of no length, none that turns back on the
// one before it or meets one that is not its neighbour.
bool is_simple_polygon(const std::vector<Eigen::Vector2d>& corners);

}  // namespace lapwing
