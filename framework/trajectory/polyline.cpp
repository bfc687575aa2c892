// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/polyline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace lapwing {

using Eigen::Vector3d;

double length_of(const Points& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

double distance_to(const std::vector<Points>& paths, const Vector3d& p) {
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const Points& path : paths) {
    if (path.size() == 1) nearest2 = std::min(nearest2, (p - path[0]).squaredNorm());
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Vector3d edge = path[i] - path[i - 1], to_p = p - path[i - 1];
      const double squared = edge.squaredNorm();
      const double share = squared > 0 ? std::clamp(to_p.dot(edge) / squared, 0.0, 1.0) : 0.0;
      nearest2 = std::min(nearest2, (to_p - share * edge).squaredNorm());
    }
  }
  return std::sqrt(nearest2);
}

Points resampled(const Points& path, double spacing) {
  const double length = length_of(path);
  const auto pieces =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length / spacing)));
  Points points{path.front()};
  double passed = 0;  // length up to path[i - 1]
  std::size_t i = 1;
  for (std::size_t k = 1; k < pieces; ++k) {
    const double wanted = length * static_cast<double>(k) / static_cast<double>(pieces);
    double edge = (path[i] - path[i - 1]).norm();
    while (passed + edge < wanted && i + 1 < path.size()) {
      passed += edge;
      ++i;
      edge = (path[i] - path[i - 1]).norm();
    }
    const double share = edge > 0 ? std::min(1.0, (wanted - passed) / edge) : 0.0;
    points.push_back(path[i - 1] + share * (path[i] - path[i - 1]));
  }
  points.push_back(path.back());
  return points;
}

Points rounded(const Points& path, double radius) {
  if (path.size() < 3 || !(radius > 0)) return path;
  const double spacing = length_of(path) / static_cast<double>(path.size() - 1);
  if (!(spacing > 0)) return path;
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3 * radius / spacing));
  const auto last = static_cast<std::ptrdiff_t>(path.size()) - 1;
  Points smooth = path;
  for (std::ptrdiff_t i = 1; i < last; ++i) {
    // Windows shrink towards the ends, which so stay where they are.
    const std::ptrdiff_t near = std::min({reach, i, last - i});
    Vector3d sum = Vector3d::Zero();
    double weights = 0;
    for (std::ptrdiff_t k = -near; k <= near; ++k) {
      const double away = static_cast<double>(k) * spacing / radius;
      const double weight = std::exp(-away * away / 2);
      sum += weight * path[static_cast<std::size_t>(i + k)];
      weights += weight;
    }
    smooth[static_cast<std::size_t>(i)] = sum / weights;
  }
  return smooth;
}

namespace {

// 1 / m: of the circle that touches both pieces in their middles; of a turn back on the spot it is
// beyond all bounds.
double curvature(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d u = b - a, v = c - b;
  const double lengths = u.norm() * v.norm(), cosine = u.dot(v);
  if (!(lengths > 0)) return 0;
  // tan of half the angle between them.
  const double tangent = u.cross(v).norm() / std::max(lengths + cosine, 1e-12 * lengths);
  const double turn = cosine < -0.999999 * lengths ? 1e6 : tangent;
  return 4 * turn / (u.norm() + v.norm());
}

// Seconds between the points, from the squares of the speeds there.
std::vector<double> times_of(const Points& path, const std::vector<double>& squared,
                             double acceleration) {
  std::vector<double> times(path.size(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double way = (path[i] - path[i - 1]).norm();
    const double sum = std::sqrt(squared[i - 1]) + std::sqrt(squared[i]);
    // Between two places that are all but rests: half of the way faster, half slower.
    const double rest = 2 * std::sqrt(way / acceleration);
    const double needed = sum * rest > 2 * way ? 2 * way / sum : rest;
    times[i] = times[i - 1] + needed;
  }
  return times;
}

// The path at one point: where it leads, and how it bends (1/m, towards the middle of its circle).
struct Course {
  Vector3d tangent = Vector3d::UnitX(), bend = Vector3d::Zero();
};

std::vector<Course> courses_of(const Points& path) {
  const std::size_t count = path.size();
  std::vector<Course> courses(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d way = path[std::min(i + 1, count - 1)] - path[i > 0 ? i - 1 : 0];
    if (way.norm() > 0) courses[i].tangent = way.normalized();
    if (i == 0 || i + 1 == count) continue;
    const Vector3d u = path[i] - path[i - 1], v = path[i + 1] - path[i];
    const Vector3d turn = v.normalized() - u.normalized();
    const Vector3d inwards = turn - turn.dot(courses[i].tangent) * courses[i].tangent;
    const double size = curvature(path[i - 1], path[i], path[i + 1]);
    if (inwards.norm() > 1e-12) courses[i].bend = size * inwards.normalized();
  }
  return courses;
}

// The share of `limit` that `value` may be multiplied by at most.
double room(double value, double limit) {
  return value > 0 ? limit / value : std::numeric_limits<double>::infinity();
}

// The square of the speed at which the limits of speed and of the bend alone are met.
double largest_square(const Course& c, const MotionLimits& l) {
  const double speed =
      std::min({room(c.tangent.head<2>().norm(), l.speed_across),
                room(c.tangent.z(), l.climb_speed), room(-c.tangent.z(), l.descent_speed)});
  return std::min({speed * speed, room(c.bend.head<2>().norm(), l.acceleration_across),
                   room(c.bend.z(), l.acceleration_up), room(-c.bend.z(), l.acceleration_down)});
}

// The largest acceleration along `sign` times the tangent that a bend at this squared speed leaves.
double largest_along(const Course& c, double squared, double sign, const MotionLimits& l) {
  const Vector3d across = squared * c.bend, way = sign * c.tangent;
  // |across + x way| within the circle, horizontally.
  const double a = way.head<2>().squaredNorm(), b = across.head<2>().dot(way.head<2>());
  const double rest =
      l.acceleration_across * l.acceleration_across - across.head<2>().squaredNorm();
  double most = a > 1e-12 ? (-b + std::sqrt(std::max(0.0, b * b + a * std::max(rest, 0.0)))) / a
                          : std::numeric_limits<double>::infinity();
  most = std::min(most, room(way.z(), l.acceleration_up - across.z()));
  most = std::min(most, room(-way.z(), l.acceleration_down + across.z()));
  return std::max(most, 0.0);
}

}  // namespace

std::vector<double> fastest_times(const Points& path, const MotionLimits& limits) {
  const std::vector<Course> courses = courses_of(path);
  const std::size_t count = path.size();
  std::vector<double> squared(count, 0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) squared[i] = largest_square(courses[i], limits);
  const auto reach = [&](std::size_t from, std::size_t to, double sign) {
    const double along = largest_along(courses[from], squared[from], sign, limits);
    squared[to] = std::min(squared[to], squared[from] + 2 * along * (path[to] - path[from]).norm());
  };
  for (std::size_t i = 1; i < count; ++i) reach(i - 1, i, 1);
  for (std::size_t i = count - 1; i > 0; --i) reach(i, i - 1, -1);
  return times_of(
      path, squared,
      std::min({limits.acceleration_across, limits.acceleration_up, limits.acceleration_down}));
}

std::vector<double> fastest_times(const Points& path, const PathLimits& limits) {
  const std::size_t count = path.size();
  std::vector<double> bend(count, 0.0), squared(count, limits.speed * limits.speed);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    bend[i] = curvature(path[i - 1], path[i], path[i + 1]);
    if (bend[i] > 0) squared[i] = std::min(squared[i], limits.acceleration / bend[i]);
  }
  squared.front() = squared.back() = 0;
  const auto reach = [&](std::size_t from, std::size_t to) {
    const double across =
        bend[from] > 0 ? std::min(bend[from] * squared[from], limits.acceleration) : 0;
    const double along =
        std::sqrt(std::max(0.0, limits.acceleration * limits.acceleration - across * across));
    // Where all goes into the bend, the next point may still be passed at the same speed.
    const double gained = 2 * along * (path[to] - path[from]).norm();
    squared[to] = std::min(squared[to], squared[from] + gained);
  };
  for (std::size_t i = 1; i < count; ++i) reach(i - 1, i);
  for (std::size_t i = count - 1; i > 0; --i) reach(i, i - 1);
  return times_of(path, squared, limits.acceleration);
}

}  // namespace lapwing
