// SPDX-License-Identifier: Apache-2.0
// How: between two neighbouring times of either path both drones move straight, so that their
// distance is a convex function of the time, also from the line below a home. It is found by
// golden-section search, to kNarrow of the span; what the search may miss is subtracted, and so is
// the bulge of both paths. Spans are looked at in blocks, those whose boxes are nearest first,
// until no other box is as near as what was found.
#include "framework/verify/drone_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kGolden = 0.6180339887498949;
constexpr double kNarrow = 1e-6;  // of the span in which the least distance is sought
constexpr int kMostSteps = 40;    // kGolden^30 is less than kNarrow

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

// All places of a drone between two times. A line reaches down without end.
Eigen::AlignedBox3d box_between(const TimedPath& path, double from, double to) {
  Eigen::AlignedBox3d box;
  bool on_line = from < path.times.front() || to > path.times.back();
  for (const double time : {from, to}) {
    const Presence end = presence_at(path, time);
    box.extend(end.top);
    on_line = on_line || end.on_line;
  }
  for (auto time = std::lower_bound(path.times.begin(), path.times.end(), from);
       time != path.times.end() && *time <= to; ++time)
    box.extend(path.places[static_cast<std::size_t>(time - path.times.begin())]);
  if (on_line) box.min().z() = -std::numeric_limits<double>::infinity();
  return box;
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
  // Of times that differ by rounding alone no half is shorter, so that steps are counted.
  for (int step = 0; step < kMostSteps && high - low > kNarrow * (to - from); ++step) {
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
      if (!path.places.empty())
        path.step = std::max(path.step, (points[k].position - path.places.back()).norm());
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

namespace {

// Spans that follow each other, and the least distance that the boxes of both drones leave.
struct Block {
  double least;
  std::size_t first, last;  // of their times
};

// The spans of all times but the first one, in blocks.
std::vector<Block> blocks_of(const TimedPath& a, const TimedPath& b,
                             const std::vector<double>& times) {
  constexpr std::size_t kSpans = 256;
  std::vector<Block> blocks;
  for (std::size_t first = 0; first + 1 < times.size(); first += kSpans) {
    const std::size_t last = std::min(first + kSpans, times.size() - 1);
    const Eigen::AlignedBox3d one = box_between(a, times[first], times[last]);
    const Eigen::AlignedBox3d other = box_between(b, times[first], times[last]);
    Vector3d apart;
    for (int axis = 0; axis < 3; ++axis)
      apart[axis] =
          std::max({0.0, one.min()[axis] - other.max()[axis], other.min()[axis] - one.max()[axis]});
    // What is subtracted of a span's distance is less than this for all of them.
    const double change = 4 * kNarrow * static_cast<double>(kSpans) * (a.step + b.step);
    blocks.push_back({apart.norm() - change - a.bulge - b.bulge, first, last});
  }
  std::sort(blocks.begin(), blocks.end(),
            [](const Block& x, const Block& y) { return x.least < y.least; });
  return blocks;
}

}  // namespace

Approach nearest_approach(const TimedPath& a, const TimedPath& b) {
  Approach nearest{std::numeric_limits<double>::infinity(), 0};
  const double from = std::max(a.first(), b.first()), to = std::min(a.last(), b.last());
  if (!(from < to)) return nearest;
  std::vector<double> times{from, to};
  add_times(a, from, to, times);
  add_times(b, from, to, times);
  std::sort(times.begin(), times.end());
  const double bulge = a.bulge + b.bulge;
  for (const Block& block : blocks_of(a, b, times)) {
    if (block.least > nearest.distance) break;
    for (std::size_t k = block.first + 1; k <= block.last; ++k) {
      if (!(times[k] > times[k - 1])) continue;
      const double middle = (times[k] + times[k - 1]) / 2;
      const double change = change_within(a, b, times[k - 1], times[k]);
      // Far away spans need no search.
      if (distance_of(presence_at(a, middle), presence_at(b, middle)) - change - bulge >
          nearest.distance)
        continue;
      Approach found = within_span(a, b, times[k - 1], times[k]);
      found.distance = std::max(0.0, found.distance - 2 * kNarrow * change - bulge);
      if (found.distance < nearest.distance ||
          (found.distance == nearest.distance && found.time < nearest.time))
        nearest = found;
    }
  }
  return nearest;
}

}  // namespace lapwing
