// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/polygon.h"

#include <algorithm>

namespace lapwing {
namespace {

double turn_of(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool lies_within(double x, double a, double b) {
  return std::min(a, b) <= x && x <= std::max(a, b);
}

// Whether p, which lies on the line through a and b, lies between them.
bool lies_between(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return lies_within(p.x(), a.x(), b.x()) && lies_within(p.y(), a.y(), b.y());
}

// Whether two segments have a point in common.
bool edges_meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                const Eigen::Vector2d& d) {
  const double a_side = turn_of(d - c, a - c), b_side = turn_of(d - c, b - c);
  const double c_side = turn_of(b - a, c - a), d_side = turn_of(b - a, d - a);
  if (((a_side > 0) != (b_side > 0) && a_side != 0 && b_side != 0) &&
      ((c_side > 0) != (d_side > 0) && c_side != 0 && d_side != 0)) {
    return true;
  }
  return (a_side == 0 && lies_between(a, c, d)) || (b_side == 0 && lies_between(b, c, d)) ||
         (c_side == 0 && lies_between(c, a, b)) || (d_side == 0 && lies_between(d, a, b));
}

}  // namespace

bool is_simple_polygon(const std::vector<Eigen::Vector2d>& corners) {
  const std::size_t n = corners.size();
  if (n < 3) return false;
  const auto corner = [&](std::size_t i) -> const Eigen::Vector2d& { return corners[i % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d edge = corner(i + 1) - corner(i), next = corner(i + 2) - corner(i + 1);
    if (!(edge.squaredNorm() > 0)) return false;
    if (turn_of(edge, next) == 0 && edge.dot(next) < 0) return false;
    const std::size_t end = i == 0 ? n - 1 : n;  // the last edge is the first one's neighbour
    for (std::size_t k = i + 2; k < end; ++k) {
      if (edges_meet(corner(i), corner(i + 1), corner(k), corner(k + 1))) return false;
    }
  }
  return true;
}

}  // namespace lapwing
