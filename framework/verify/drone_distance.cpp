// SPDX-License-Identifier: Apache-2.0
// How: between two neighbouring times of either path both drones move straight, so that their
// distance is a convex function of the time, also from the line below a home. It is found by
// golden-section search, to kNarrow of the span; what the search may miss is subtracted, and so is
// the bulge of both paths.
#include "framework/verify/drone_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kGolden = 0.6180339887498949;
constexpr double kNarrow = 1e-6;  // of the span in which the least distance is sought

// Where a drone is, or the top of the line on which it is.
struct Presence {
  Vector3d top;
  bool on_line;
};

Presence presence_at(const TimedPath& path, double time) {
  if (time < path.times.front()) return {path.places.front(), true};
  if (time > path.times.back()) return {path.places.back(), true};
  const auto after = std::upper_bound(path.times.begin(), path.times.end(), time);
  if (after == path.times.end()) return {path.places.back(), false};
  const auto k = static_cast<std::size_t>(after - path.times.begin());
  const double share = (time - path.times[k - 1]) / (path.times[k] - path.times[k - 1]);
  return {path.places[k - 1] + share * (path.places[k] - path.places[k - 1]), false};
}

double distance_of(const Presence& a, const Presence& b) {
  Vector3d between = b.top - a.top;
  if (a.on_line && b.on_line)
    between.z() = 0;
  else if (a.on_line)  // a point below the top is on the line
    between.z() = std::max(0.0, between.z());
  else if (b.on_line)
    between.z() = std::min(0.0, between.z());
  return between.norm();
}

Approach within_span(const TimedPath& a, const TimedPath& b, double from, double to) {
  // At a boundary between flight and line the span's own side counts: its inside is asked.
  const double inset = 1e-9 * (to - from);
  const auto at = [&](double time) {
    const double inside = std::clamp(time, from + inset, to - inset);
    return distance_of(presence_at(a, inside), presence_at(b, inside));
  };
  Approach best{at(from), from};
  const auto see = [&](double time) {
    const double distance = at(time);
    if (distance < best.distance) best = {distance, time};
    return distance;
  };
  see(to);
  double low = from, high = to;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double of_left = see(left), of_right = see(right);
  while (high - low > kNarrow * (to - from)) {
    if (of_left <= of_right) {
      high = right;
      right = left;
      of_right = of_left;
      left = high - kGolden * (high - low);
      of_left = see(left);
    } else {
      low = left;
      left = right;
      of_left = of_right;
      right = low + kGolden * (high - low);
      of_right = see(right);
    }
  }
  return best;
}

// How far the distance can change within the span.
double change_within(const TimedPath& a, const TimedPath& b, double from, double to) {
  const double inset = 1e-9 * (to - from);
  const auto moved = [&](const TimedPath& path) {
    return (presence_at(path, to - inset).top - presence_at(path, from + inset).top).norm();
  };
  return moved(a) + moved(b);
}

void add_times(const TimedPath& path, double from, double to, std::vector<double>& times) {
  for (auto time = std::upper_bound(path.times.begin(), path.times.end(), from);
       time != path.times.end() && *time < to; ++time)
    times.push_back(*time);
}

}  // namespace

TimedPath timed_path(Motion& motion, std::string drone, double start, double climb) {
  TimedPath path;
  path.drone = std::move(drone);
  path.climb = climb;
  for (std::size_t interval = 0; interval < motion.intervals(); ++interval) {
    const auto points = motion.integrate(interval);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double time = start + points[k].time;
      if (k > 0) {
        // Of a motion with an even change of velocity, in the middle of the step.
        const double lasts = points[k].time - points[k - 1].time;
        const Vector3d change = points[k].velocity - points[k - 1].velocity;
        path.bulge = std::max(path.bulge, change.norm() * lasts / 8);
      }
      if (!path.times.empty() && time <= path.times.back()) {
        path.bulge = std::max(path.bulge, (points[k].position - path.places.back()).norm());
        continue;
      }
      path.times.push_back(time);
      path.places.push_back(points[k].position);
    }
  }
  if (path.times.empty()) {
    path.times.push_back(start);
    path.places.push_back(motion.stated(0).position);
  }
  return path;
}

Approach nearest_approach(const TimedPath& a, const TimedPath& b) {
  Approach nearest{std::numeric_limits<double>::infinity(), 0};
  const double from = std::max(a.first(), b.first()), to = std::min(a.last(), b.last());
  if (!(from < to)) return nearest;
  std::vector<double> times{from, to};
  add_times(a, from, to, times);
  add_times(b, from, to, times);
  std::sort(times.begin(), times.end());
  const double bulge = a.bulge + b.bulge;
  for (std::size_t k = 1; k < times.size(); ++k) {
    if (!(times[k] > times[k - 1])) continue;
    const double middle = (times[k] + times[k - 1]) / 2;
    const double change = change_within(a, b, times[k - 1], times[k]);
    // Far away spans need no search.
    if (distance_of(presence_at(a, middle), presence_at(b, middle)) - change - bulge >
        nearest.distance)
      continue;
    Approach found = within_span(a, b, times[k - 1], times[k]);
    found.distance = std::max(0.0, found.distance - 2 * kNarrow * change - bulge);
    if (found.distance < nearest.distance) nearest = found;
  }
  return nearest;
}

}  // namespace lapwing
