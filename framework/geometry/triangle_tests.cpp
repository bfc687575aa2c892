// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/triangle_tests.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lapwing {

using Eigen::Vector3d;

namespace {

Vector3d nearest_on(const Vector3d& from, const Vector3d& to, const Vector3d& p) {
  const Vector3d way = to - from;
  const double squared = way.squaredNorm();
  return squared > 0 ? Vector3d(from + std::clamp((p - from).dot(way) / squared, 0.0, 1.0) * way)
                     : from;
}

// Of a triangle as narrow as a hair the signs of areas are rounding. What is nearest of its edges
// and of the place in it that p stands over, as far as that is known.
Vector3d nearest_of_narrow(const Triangle& t, const Vector3d& p) {
  const Vector3d ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a, n = ab.cross(ac);
  Vector3d best = nearest_on(t.a, t.b, p);
  const auto offer = [&](const Vector3d& q) {
    if ((p - q).squaredNorm() < (p - best).squaredNorm()) best = q;
  };
  offer(nearest_on(t.b, t.c, p));
  offer(nearest_on(t.c, t.a, p));
  const double v = ap.cross(ac).dot(n) / n.squaredNorm(), w = ab.cross(ap).dot(n) / n.squaredNorm();
  if (v >= 0 && w >= 0 && v + w <= 1) offer(t.a + v * ab + w * ac);
  return best;
}

}  // namespace

// Which corner, edge or the face itself is nearest, by the signs of projections on the edges
// (Ericson, Real-Time Collision Detection, 5.1.5).
Vector3d nearest_point(const Triangle& t, const Vector3d& p) {
  constexpr double kNarrow = 1e-8;  // squared sine of the angle at a
  const Vector3d ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a;
  if (ab.cross(ac).squaredNorm() <= kNarrow * ab.squaredNorm() * ac.squaredNorm())
    return nearest_of_narrow(t, p);
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return t.a;
  const Vector3d bp = p - t.b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return t.b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t.a + d1 / (d1 - d3) * ab;
  const Vector3d cp = p - t.c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return t.c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t.a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return t.b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t.c - t.b);
  }
  const double sum = va + vb + vc;
  return t.a + vb / sum * ab + vc / sum * ac;
}

double plane_distance(const Triangle& t, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d n = (t.b - t.a).cross(t.c - t.a);
  const double towards = n.dot(direction);
  return towards == 0 ? std::nan("") : n.dot(t.a - origin) / towards;
}

bool swept_box_meets(const Triangle& t, const Vector3d& from, const Vector3d& to,
                     const Vector3d& half) {
  const Vector3d d = (to - from) / 2, middle = (from + to) / 2;
  const Vector3d corner[3] = {t.a - middle, t.b - middle, t.c - middle};
  // Touching counts as apart, up to what rounding does to numbers of this size.
  const double slack = 1e-9 * (1 + half.maxCoeff());
  const auto apart = [&](const Vector3d& axis) {
    const double length = axis.norm();
    if (!(length > 1e-12)) return false;
    const double reach = half.dot(axis.cwiseAbs()) + std::abs(axis.dot(d));
    const double p0 = axis.dot(corner[0]), p1 = axis.dot(corner[1]), p2 = axis.dot(corner[2]);
    const double low = std::min({p0, p1, p2}), high = std::max({p0, p1, p2});
    return low >= reach - slack * length || high <= -reach + slack * length;
  };
  const Vector3d edge[3] = {t.b - t.a, t.c - t.b, t.a - t.c};
  for (int i = 0; i < 3; ++i) {
    const Vector3d axis = Vector3d::Unit(i);
    if (apart(axis) || apart(axis.cross(d))) return false;
    for (const Vector3d& e : edge)
      if (apart(axis.cross(e))) return false;
  }
  for (const Vector3d& e : edge)
    if (apart(d.cross(e))) return false;
  return !apart(edge[0].cross(edge[1]));
}

}  // namespace lapwing
