// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/winding.h"

#include <cmath>
#include <numbers>

namespace lapwing {

// tan(angle / 2) = a (b x c) / (|a| |b| |c| + (a b) |c| + (b c) |a| + (c a) |b|), of the corners as
// seen from the point.
double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& p_W) {
  double half = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d a = mesh.corner(t, 0) - p_W, b = mesh.corner(t, 1) - p_W,
                          c = mesh.corner(t, 2) - p_W;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    half +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return half / (2 * std::numbers::pi);
}

}  // namespace lapwing
