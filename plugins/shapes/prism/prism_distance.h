// SPDX-License-Identifier: Apache-2.0
// The signed distance from a prism, which can be differentiated.
//
// The nearest edge or corner is found by value; inside, the distance is minus that to the nearest
// face, which is the way out. World frame, metres.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "framework/core/dual.h"

namespace lapwing {

// A polygon that does not cross itself, whose edges know their way out.
class PrismPolygon {
 public:
  explicit PrismPolygon(std::vector<Eigen::Vector2d> corners) {
    double twice_area = 0;
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
      twice_area += corners[j].x() * corners[i].y() - corners[i].x() * corners[j].y();
      if (corners[i] != corners[j]) corners_.push_back(corners[i]);
    }
    if (twice_area < 0) std::reverse(corners_.begin(), corners_.end());
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d edge = corners_[next(i)] - corners_[i];
      outward_.emplace_back(Eigen::Vector2d(edge.y(), -edge.x()).normalized());
    }
  }

  // Whether no corner is turned inwards.
  bool convex() const {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d edge = corners_[next(next(i))] - corners_[next(i)];
      if (outward_[i].dot(edge) > 0) return false;
    }
    return true;
  }

  // Signed distance, negative inside: the nearest edge or corner is found by value.
  template <class T>
  T distance(const T& x, const T& y) const {
    using std::sqrt;
    constexpr double kCorner = 1e-6;  // m
    const Eigen::Vector2d p(value_of(x), value_of(y));
    const Nearest nearest = nearest_part(p);
    const Eigen::Vector2d& corner = corners_[nearest.corner];
    const T dx = x - corner.x(), dy = y - corner.y();
    if (nearest.on_edge) {
      const Eigen::Vector2d& out = outward_[nearest.corner];
      return out.x() * dx + out.y() * dy;
    }
    if (nearest.distance < kCorner) {  // on the corner itself: out between its edges
      const Eigen::Vector2d out = way_out(nearest.corner);
      return out.x() * dx + out.y() * dy;
    }
    const T away = sqrt(dx * dx + dy * dy);
    return nearest.inside ? -away : away;
  }

 private:
  struct Nearest {
    std::size_t corner = 0;  // or the one where the edge begins
    bool on_edge = false, inside = false;
    double distance = std::numeric_limits<double>::infinity();
  };

  std::size_t next(std::size_t i) const { return i + 1 < corners_.size() ? i + 1 : 0; }

  Nearest nearest_part(const Eigen::Vector2d& p) const {
    Nearest nearest;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d &a = corners_[i], &b = corners_[next(i)];
      const Eigen::Vector2d edge = b - a;
      const double share = std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      const double distance = (p - a - share * edge).norm();
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) / edge.y() * edge.x())
        nearest.inside = !nearest.inside;
      if (distance >= nearest.distance) continue;
      nearest.distance = distance;
      nearest.on_edge = share > 0 && share < 1;
      nearest.corner = share < 1 ? i : next(i);
    }
    return nearest;
  }

  Eigen::Vector2d way_out(std::size_t corner) const {
    const Eigen::Vector2d& before = outward_[corner > 0 ? corner - 1 : corners_.size() - 1];
    const Eigen::Vector2d sum = before + outward_[corner];
    return sum.norm() > 1e-3 ? sum.normalized() : before;  // a spike of no width
  }

  std::vector<Eigen::Vector2d> corners_;  // counter-clockwise
  std::vector<Eigen::Vector2d> outward_;  // of the edge from each corner to the next
};

class PrismDistance {
 public:
  PrismDistance(std::vector<Eigen::Vector2d> corners, double floor, double ceiling)
      : polygon_(std::move(corners)), floor_(floor), ceiling_(ceiling) {}

  bool convex() const { return polygon_.convex(); }

  template <class T>
  T distance(const T* p) const {
    using std::max, std::sqrt;
    const T across = polygon_.distance(p[0], p[1]);
    if (std::isinf(floor_) && std::isinf(ceiling_)) return across;
    T up;
    if (std::isinf(ceiling_))
      up = floor_ - p[2];
    else if (std::isinf(floor_))
      up = p[2] - ceiling_;
    else
      up = max(p[2] - ceiling_, floor_ - p[2]);
    if (value_of(across) > 0 && value_of(up) > 0) return sqrt(across * across + up * up);
    return max(up, across);
  }

 private:
  PrismPolygon polygon_;
  double floor_, ceiling_;  // m, perhaps infinite
};

}  // namespace lapwing
