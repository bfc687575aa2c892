// SPDX-License-Identifier: Apache-2.0
// When the keyframes along a path are passed: where on the path each one is, and the cheapest times
// that grant what each asks for.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "framework/trajectory/polyline.h"

namespace lapwing {

// What a keyframe asks of its time. A `time` without a weight is exact, and one with a weight is
// preferred; `earliest` and `latest` are a window. Nothing: any time.
struct TimeWish {
  std::optional<double> time;         // s
  std::optional<double> time_weight;  // per s^2; only with a time
  std::optional<double> earliest;     // s
  std::optional<double> latest;       // s

  bool any() const { return time || time_weight || earliest || latest; }
};

struct KeyframeTimes {
  std::vector<double> times;           // s, one per keyframe, the first 0; empty where refused
  std::optional<std::size_t> refused;  // the first keyframe that can have none of its times
};

// Minimises  t[n-1] + sum of time_weight[k] (t[k] - time[k])^2  over t[0] = 0 and
// t[k] - t[k-1] >= legs[k-1], within exact times and windows. Method: in s[k] = t[k] - (legs before
// k) this is an isotonic regression within bounds; pooling adjacent violators finds its exact
// optimum in linear time (Best, Chakravarti and Ubhaya, SIAM J. Optim. 10, 2000). Of several optima
// it takes the one at which keyframes are passed earliest.
// `legs`: shortest durations, s, above 0, one fewer than wishes. Error for another number of legs.
KeyframeTimes cheapest_times(std::span<const TimeWish> wishes, std::span<const double> legs);

// For each keyframe the number of the nearest point of the path, in order: no stop comes before the
// one of the keyframe before. The first is 0 and the last is the path's last point. A stop is
// looked for within three times the mean number of points between keyframes. Both lists at least
// one long (Error).
std::vector<std::size_t> keyframe_stops(const Points& path, const Points& keyframes);

}  // namespace lapwing
