// SPDX-License-Identifier: Apache-2.0
// Single triangles against rays, points and swept boxes, in double precision. Internal to this
// room.
#pragma once

#include <Eigen/Core>

namespace lapwing {

struct Triangle {
  Eigen::Vector3d a, b, c;
};

// The point of the triangle that is nearest to p.
Eigen::Vector3d nearest_point(const Triangle& triangle, const Eigen::Vector3d& p);

// The distance along the ray to the triangle's plane; NaN where the two are parallel.
double plane_distance(const Triangle& triangle, const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction);

// Whether the inside of a box (half edges `half`, parallel to the axes) that moves from `from` to
// `to` meets the triangle: the separating axes of the swept box, which is convex, and the triangle.
bool swept_box_meets(const Triangle& triangle, const Eigen::Vector3d& from,
                     const Eigen::Vector3d& to, const Eigen::Vector3d& half);

}  // namespace lapwing
