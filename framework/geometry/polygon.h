// SPDX-License-Identifier: Apache-2.0
// Polygons on the ground.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

// Whether corners bound one area: at least three, no edge of no length, none that turns back on the
// one before it or meets one that is not its neighbour.
bool is_simple_polygon(const std::vector<Eigen::Vector2d>& corners);

// Why corners bound no area or more than one, with numbers of corners and places: "its edges 2 and
// 5 cross or touch near (3, 4.5)". "" where is_simple_polygon holds and the area is above 0.
std::string polygon_fault(const std::vector<Eigen::Vector2d>& corners);

// Whether a place lies within a simple polygon. Places on an edge may fall to either side, but of
// two polygons with that edge in common to one of them only.
bool polygon_contains(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p);

double polygon_area(const std::vector<Eigen::Vector2d>& corners);  // m^2, of any orientation

// Why a polygon does not lie within another one: "its corner 3 lies outside", "its edge 1 crosses
// edge 4 of it". "" where it does; a shared edge or corner is allowed. Both are simple.
std::string fault_within(const std::vector<Eigen::Vector2d>& inner,
                         const std::vector<Eigen::Vector2d>& outer);

}  // namespace lapwing
