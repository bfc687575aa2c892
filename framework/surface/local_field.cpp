// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/local_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapwing {

using Eigen::Vector3d;

LocalField::LocalField(const std::vector<FusedPoint>& points, double width, double reach)
    : width_(width), reach_(reach), points_(points) {
  std::sort(points_.begin(), points_.end(), [&](const FusedPoint& a, const FusedPoint& b) {
    const Cell ca = cell_of(a.position), cb = cell_of(b.position);
    if (ca != cb) return ca < cb;
    // Sums must not depend on the order in which the points came.
    for (int i = 0; i < 3; ++i)
      if (a.position[i] != b.position[i]) return a.position[i] < b.position[i];
    return false;
  });
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Cell cell = cell_of(points_[i].position);
    if (cells_.empty() || cells_.back().first != cell) cells_.push_back({cell, i});
  }
}

LocalField::Cell LocalField::cell_of(const Vector3d& p) const {
  const auto at = [&](double v) { return static_cast<std::int64_t>(std::floor(v / reach_)); };
  return {at(p.x()), at(p.y()), at(p.z())};
}

double LocalField::value(const Vector3d& p) const {
  const Cell middle = cell_of(p);
  // Weights count from the nearest point, so that they do not vanish all at once.
  double nearest = std::numeric_limits<double>::infinity(), sum = 0, weights = 0;
  for (std::int64_t x = -1; x <= 1; ++x) {
    for (std::int64_t y = -1; y <= 1; ++y) {
      // The three cells above each other are one piece of the list.
      const Cell low{middle[0] + x, middle[1] + y, middle[2] - 1};
      auto cell = std::lower_bound(
          cells_.begin(), cells_.end(), low,
          [](const auto& entry, const Cell& wanted) { return entry.first < wanted; });
      for (; cell != cells_.end() && cell->first[0] == low[0] && cell->first[1] == low[1] &&
             cell->first[2] <= middle[2] + 1;
           ++cell) {
        const std::size_t end = cell + 1 == cells_.end() ? points_.size() : (cell + 1)->second;
        for (std::size_t i = cell->second; i < end; ++i) {
          const Vector3d off = p - points_[i].position;
          const double distance = off.squaredNorm() / (width_ * width_);
          if (distance < nearest) {
            const double less = std::exp(distance - nearest);
            sum *= less;
            weights *= less;
            nearest = distance;
          }
          const double weight = std::exp(nearest - distance);
          sum += weight * off.dot(points_[i].normal);
          weights += weight;
        }
      }
    }
  }
  return weights > 0 ? sum / weights : 1;
}

}  // namespace lapwing
