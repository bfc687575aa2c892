// SPDX-License-Identifier: Apache-2.0
#include "framework/shape/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The part of a ray within a box, as distances along it; nothing where it misses.
std::optional<std::pair<double, double>> within(const Eigen::AlignedBox3d& box,
                                                const Eigen::Vector3d& origin,
                                                const Eigen::Vector3d& direction) {
  double enter = 0, leave = kInfinity;
  for (int i = 0; i < 3; ++i) {
    if (direction(i) == 0) {
      if (origin(i) < box.min()(i) || origin(i) > box.max()(i)) return std::nullopt;
      continue;
    }
    const double a = (box.min()(i) - origin(i)) / direction(i);
    const double b = (box.max()(i) - origin(i)) / direction(i);
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > leave) return std::nullopt;
  return std::pair{enter, leave};
}

}  // namespace

double Shape::reach() const {
  return kInfinity;
}

std::optional<SurfaceHit> Shape::hit(const Eigen::Vector3d& origin,
                                     const Eigen::Vector3d& direction) const {
  constexpr double kSlack = 1e-6, kTouch = 1e-7, kFarthest = 4e5;  // m
  constexpr int kMostSteps = 20'000;
  const Eigen::Vector3d slack = Eigen::Vector3d::Constant(kSlack);
  const Eigen::AlignedBox3d box = bounds();
  if (box.isEmpty()) return std::nullopt;
  const auto part = within({box.min() - slack, box.max() + slack}, origin, direction);
  if (!part) return std::nullopt;
  const double last = std::min(part->second, kFarthest);
  // Away from a surface on which the ray begins.
  double at = std::max(part->first, 2 * kSlack);
  const double side = distance(origin + at * direction, nullptr) < 0 ? -1 : 1;
  for (int step = 0; step < kMostSteps && at <= last; ++step) {
    Eigen::Vector3d normal;
    const double room = side * distance(origin + at * direction, &normal);
    if (room < kTouch && (room < 0 || side * normal.dot(direction) < 0)) {
      const double length = normal.norm();
      normal = length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d(-direction);
      if (normal.dot(direction) > 0) normal = -normal;
      return SurfaceHit{at, normal};
    }
    at += std::max(room, kTouch);
  }
  return std::nullopt;
}

}  // namespace lapwing
