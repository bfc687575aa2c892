// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

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

// Whether two segments cross at a place that is inside of both.
bool edges_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                 const Eigen::Vector2d& d) {
  const double a_side = turn_of(d - c, a - c), b_side = turn_of(d - c, b - c);
  const double c_side = turn_of(b - a, c - a), d_side = turn_of(b - a, d - a);
  return a_side * b_side < 0 && c_side * d_side < 0;
}

// m from a place to a segment.
double distance_from_edge(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                          const Eigen::Vector2d& b) {
  const Eigen::Vector2d edge = b - a;
  const double length = edge.squaredNorm();
  const double share = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0.0;
  return (p - a - share * edge).norm();
}

std::string place_text(const Eigen::Vector2d& p) {
  char text[80];
  std::snprintf(text, sizeof text, "(%.6g, %.6g)", p.x(), p.y());
  return text;
}

// Near where two edges meet: the end of one that is nearest to the other, or where they cross.
Eigen::Vector2d meeting_place(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                              const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  if (edges_cross(a, b, c, d)) {
    const double share = turn_of(c - a, d - c) / turn_of(b - a, d - c);
    return a + share * (b - a);
  }
  Eigen::Vector2d best = a;
  double least = distance_from_edge(a, c, d);
  const auto see = [&](const Eigen::Vector2d& p, double distance) {
    if (distance < least) least = distance, best = p;
  };
  see(b, distance_from_edge(b, c, d));
  see(c, distance_from_edge(c, a, b));
  see(d, distance_from_edge(d, a, b));
  return best;
}

// Whether all corners lie on one line, but for a millionth of their extent.
bool lies_on_a_line(const std::vector<Eigen::Vector2d>& corners) {
  constexpr double kFlat = 1e-6;
  const Eigen::Vector2d& first = corners.front();
  Eigen::Vector2d farthest = first;
  for (const Eigen::Vector2d& p : corners)
    if ((p - first).squaredNorm() > (farthest - first).squaredNorm()) farthest = p;
  const Eigen::Vector2d along = farthest - first;
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& p) {
    return std::abs(turn_of(along, p - first)) <= kFlat * along.squaredNorm();
  });
}

}  // namespace

std::string polygon_fault(const std::vector<Eigen::Vector2d>& corners) {
  const std::size_t n = corners.size();
  if (n < 3) return "it has " + std::to_string(n) + " corners; expected at least three";
  const auto corner = [&](std::size_t i) -> const Eigen::Vector2d& { return corners[i % n]; };
  const auto number = [&](std::size_t i) { return std::to_string(i % n + 1); };
  for (std::size_t i = 0; i < n; ++i) {
    if (corner(i) == corner(i + 1))
      return "its corners " + number(i) + " and " + number(i + 1) + " coincide at " +
             place_text(corner(i));
  }
  if (lies_on_a_line(corners)) return "it has no area: its corners lie on one line";
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d edge = corner(i + 1) - corner(i), next = corner(i + 2) - corner(i + 1);
    if (turn_of(edge, next) == 0 && edge.dot(next) < 0)
      return "its edge " + number(i + 1) + " turns back on the one before it at " +
             place_text(corner(i + 1));
    const std::size_t end = i == 0 ? n - 1 : n;
    for (std::size_t k = i + 2; k < end; ++k) {
      if (edges_meet(corner(i), corner(i + 1), corner(k), corner(k + 1)))
        return "its edges " + number(i) + " and " + number(k) + " cross or touch near " +
               place_text(meeting_place(corner(i), corner(i + 1), corner(k), corner(k + 1))) +
               "; list the corners in order around it";
    }
  }
  return "";
}

bool polygon_contains(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    // The lower end first, so that an edge gives the same place for both polygons beside it.
    const Eigen::Vector2d &a = corners[i].y() < corners[j].y() ? corners[i] : corners[j],
                          &b = corners[i].y() < corners[j].y() ? corners[j] : corners[i];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

double polygon_area(const std::vector<Eigen::Vector2d>& corners) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    twice += turn_of(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return std::abs(twice) / 2;
}

std::string fault_within(const std::vector<Eigen::Vector2d>& inner,
                         const std::vector<Eigen::Vector2d>& outer) {
  constexpr double kOnEdge = 1e-6;  // m
  const auto outside = [&](const Eigen::Vector2d& p) {
    if (polygon_contains(outer, p)) return false;
    for (std::size_t k = 0; k < outer.size(); ++k)
      if (distance_from_edge(p, outer[k], outer[(k + 1) % outer.size()]) <= kOnEdge) return false;
    return true;
  };
  for (std::size_t i = 0; i < inner.size(); ++i) {
    if (outside(inner[i]))
      return "its corner " + std::to_string(i + 1) + " at " + place_text(inner[i]) +
             " lies outside";
  }
  for (std::size_t i = 0; i < inner.size(); ++i) {
    const Eigen::Vector2d &a = inner[i], &b = inner[(i + 1) % inner.size()];
    for (std::size_t k = 0; k < outer.size(); ++k) {
      const Eigen::Vector2d &c = outer[k], &d = outer[(k + 1) % outer.size()];
      const bool touches =
          distance_from_edge(a, c, d) <= kOnEdge || distance_from_edge(b, c, d) <= kOnEdge ||
          distance_from_edge(c, a, b) <= kOnEdge || distance_from_edge(d, a, b) <= kOnEdge;
      if (!touches && edges_cross(a, b, c, d))
        return "its edge " + std::to_string(i + 1) + " crosses edge " + std::to_string(k + 1) +
               " of it near " + place_text(meeting_place(a, b, c, d));
    }
    if (outside((a + b) / 2))  // along a bay of the outer one, from edge to edge
      return "the middle of its edge " + std::to_string(i + 1) + ", " + place_text((a + b) / 2) +
             ", lies outside";
  }
  return "";
}

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
