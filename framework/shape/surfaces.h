// SPDX-License-Identifier: Apache-2.0
// Surfaces that shapes are drawn and judged by. World frame, metres.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

// Chords of a circle, or of half of it, that stay within `tolerance` of it; 8 at least.
int chords_of(double radius, double tolerance);

// A profile turned about an upright axis, closed: `profile` holds the distance from the axis and
// the height of each of its points from the bottom up; where an end is not on the axis, a disc
// closes it. `R` turns the axis.
TriangleMesh turned_surface(const std::vector<Eigen::Vector2d>& profile, int chords,
                            const Eigen::Vector3d& origin,
                            const Eigen::Matrix3d& R = Eigen::Matrix3d::Identity());

TriangleMesh box_surface(const Eigen::AlignedBox3d& box);

// What of a box lies behind a plane, n (p - point) <= 0, n unit.
TriangleMesh cut_box(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& point,
                     const Eigen::Vector3d& normal);

// A prism over a simple polygon.
TriangleMesh prism_surface(std::vector<Eigen::Vector2d> corners, double floor, double ceiling);

}  // namespace lapwing
