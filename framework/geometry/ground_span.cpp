// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/ground_span.h"

#include <algorithm>
#include <cmath>

#include "framework/geometry/polygon.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;

class Span {
 public:
  explicit Span(const HeightGrid& ground) : ground_(ground) {}

  void see(int column, int row) {
    if (column < 0 || row < 0 || column >= ground_.columns() || row >= ground_.rows()) return;
    const double z = ground_.at(column, row);
    if (std::isnan(z)) return;
    if (!span_) span_ = GroundSpan{z, z};
    span_->lowest = std::min(span_->lowest, z);
    span_->highest = std::max(span_->highest, z);
  }

  // The grid points around a place.
  void see_around(const Vector2d& p) {
    const Vector2d at = (p - ground_.place(0, 0)) / ground_.step();
    // Places far beside the grid have no neighbours in it.
    if (!(at.cwiseAbs().maxCoeff() < 1e9)) return;
    const int column = static_cast<int>(std::floor(at.x()));
    const int row = static_cast<int>(std::floor(at.y()));
    for (int corner = 0; corner < 4; ++corner) see(column + (corner & 1), row + (corner >> 1));
  }

  std::optional<GroundSpan> take() const { return span_; }

 private:
  const HeightGrid& ground_;
  std::optional<GroundSpan> span_;
};

// The part of an edge over the grid and a step around it, as shares of its length; nothing where
// there is none.
std::optional<std::pair<double, double>> clipped(const Vector2d& from, const Vector2d& along,
                                                 const Eigen::AlignedBox2d& box) {
  double begin = 0, end = 1;
  for (int axis = 0; axis < 2; ++axis) {
    double near = box.min()[axis] - from[axis], far = box.max()[axis] - from[axis];
    if (along[axis] == 0) {
      if (near > 0 || far < 0) return std::nullopt;
      continue;
    }
    near /= along[axis], far /= along[axis];
    begin = std::max(begin, std::min(near, far));
    end = std::min(end, std::max(near, far));
  }
  if (begin > end) return std::nullopt;
  return std::pair(begin, end);
}

}  // namespace

std::optional<GroundSpan> ground_span(const HeightGrid& ground, const GroundPolygon& polygon) {
  Span span(ground);
  Eigen::AlignedBox2d around;
  for (const Vector2d& corner : polygon) around.extend(corner);
  const Vector2d first = ground.place(0, 0);
  const Vector2d last = ground.place(ground.columns() - 1, ground.rows() - 1);
  for (int row = 0; row < ground.rows(); ++row)
    for (int column = 0; column < ground.columns(); ++column) {
      const Vector2d p = ground.place(column, row);
      if (around.contains(p) && polygon_contains(polygon, p)) span.see(column, row);
    }
  const Vector2d margin = Vector2d::Constant(ground.step());
  const Eigen::AlignedBox2d grid(first - margin, last + margin);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d from = polygon[i], along = polygon[(i + 1) % polygon.size()] - from;
    const auto part = clipped(from, along, grid);
    if (!part) continue;
    const double length = (part->second - part->first) * along.norm();
    const int steps = 1 + static_cast<int>(std::ceil(4 * length / ground.step()));
    for (int k = 0; k <= steps; ++k) {
      const double share = part->first + k * (part->second - part->first) / steps;
      span.see_around(from + share * along);
    }
  }
  return span.take();
}

}  // namespace lapwing
