// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/keyframe_timing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "framework/core/error.h"

namespace lapwing {

namespace {

constexpr double kGrid = 0.05;        // s
constexpr double kMostTimes = 20000;  // of the grid
constexpr double kSame = 1e-9;        // s
constexpr std::size_t kMostEntries = 50'000'000;
constexpr double kNever = std::numeric_limits<double>::infinity();

// The cost of passing a keyframe at `time`; infinite where it may not be passed then.
double price_of(const TimeWish& wish, double time, bool is_last) {
  const double cost = is_last ? time : 0;
  if (wish.time_weight) {
    const double late = time - *wish.time;
    return cost + *wish.time_weight * (late * late);
  }
  if (wish.time && std::abs(time - *wish.time) > kSame) return kNever;
  if (time < wish.earliest.value_or(0) - kSame || time > wish.latest.value_or(kNever) + kSame)
    return kNever;
  return cost;
}

// The grid and every time that a wish names, in rising order.
std::vector<double> candidate_times(std::span<const TimeWish> wishes, double fastest) {
  std::vector<double> times;
  double finish = fastest;
  for (const TimeWish& wish : wishes) {
    for (const double time :
         {wish.time.value_or(0), wish.earliest.value_or(0), wish.latest.value_or(0)}) {
      finish = std::max(finish, time);
      times.push_back(time);
    }
  }
  const double room = finish + fastest, step = std::max(kGrid, room / kMostTimes);
  const double steps = std::ceil(room / step);
  for (double i = 0; i <= steps; ++i) times.push_back(i * step);
  std::sort(times.begin(), times.end());
  return times;
}

}  // namespace

KeyframeTimes cheapest_times(std::span<const TimeWish> wishes, std::span<const double> legs) {
  if (wishes.empty() || legs.size() + 1 != wishes.size())
    throw Error("cheapest_times: one leg fewer than keyframes is needed");
  double fastest = 0;
  for (const double leg : legs) fastest += leg;
  const std::vector<double> times = candidate_times(wishes, fastest);
  const std::size_t count = wishes.size();
  if (times.size() > kMostEntries / count)
    throw InputError("keyframe times: " + std::to_string(count) + " keyframes over " +
                     std::to_string(times.size()) + " times are too many; expected " +
                     std::to_string(kMostEntries) + " pairs at most");
  // least[j]: the least cost of all keyframes so far, the last of them at times[j]. came[k - 1][j]:
  // the time of the keyframe before on the way to it.
  std::vector<double> least(times.size(), kNever);
  std::vector<std::vector<std::uint32_t>> came;
  for (std::size_t j = 0; j < times.size(); ++j)
    if (times[j] == 0) least[j] = price_of(wishes[0], 0, count == 1);
  for (std::size_t k = 1; k < count; ++k) {
    std::vector<double> next(times.size(), kNever);
    std::vector<std::uint32_t>& from = came.emplace_back(times.size(), 0);
    double best = kNever;
    std::uint32_t place = 0, i = 0;
    for (std::size_t j = 0; j < times.size(); ++j) {
      for (; i < times.size() && times[i] <= times[j] - legs[k - 1] + kSame; ++i) {
        if (least[i] < best) {
          best = least[i];
          place = i;
        }
      }
      if (best < kNever) next[j] = best + price_of(wishes[k], times[j], k + 1 == count);
      from[j] = place;
    }
    least = std::move(next);
    if (*std::min_element(least.begin(), least.end()) == kNever) return {.times = {}, .refused = k};
  }
  auto last =
      static_cast<std::size_t>(std::min_element(least.begin(), least.end()) - least.begin());
  if (least[last] == kNever) return {.times = {}, .refused = 0};
  std::vector<double> chosen(count);
  for (std::size_t k = count; k-- > 0;) {
    chosen[k] = times[last];
    if (k > 0) last = came[k - 1][last];
  }
  for (std::size_t k = 1; k < count; ++k)
    if (!wishes[k].any()) chosen[k] = std::min(chosen[k], chosen[k - 1] + legs[k - 1]);
  return {.times = std::move(chosen), .refused = std::nullopt};
}

std::vector<std::size_t> keyframe_stops(const Points& path, const Points& keyframes) {
  if (path.empty() || keyframes.empty())
    throw Error("keyframe_stops: a point of the path and a keyframe are needed");
  const std::size_t around = std::max<std::size_t>(1, path.size() / keyframes.size());
  std::vector<std::size_t> stops;
  std::size_t first = 0;
  for (const Eigen::Vector3d& place : keyframes) {
    const std::size_t end = std::min(path.size(), first + 1 + (stops.empty() ? 0 : 3 * around));
    double least = kNever;
    std::size_t best = first;
    for (std::size_t j = first; j < end; ++j) {
      if (const double far = (path[j] - place).norm(); far < least) {
        least = far;
        best = j;
      }
    }
    stops.push_back(first = best);
  }
  stops.front() = 0;
  stops.back() = path.size() - 1;
  return stops;
}

}  // namespace lapwing
