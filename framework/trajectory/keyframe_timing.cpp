// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/keyframe_timing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/error.h"

namespace lapwing {

namespace {

constexpr double kSame = 1e-9;  // s
constexpr double kNever = std::numeric_limits<double>::infinity();

// What one keyframe asks of s, its time less the legs before it.
struct Ask {
  double lower = 0, upper = kNever;
  double square = 0, slope = 0;  // it costs square s^2 + slope s
};

// Keyframes that are passed as soon after each other as their legs allow: they share one s.
struct Pool {
  std::size_t first = 0;
  double lower = 0, upper = 0, square = 0, slope = 0;

  // The smallest s at which the pool costs least.
  double best() const {
    if (square == 0) return lower;
    return std::clamp(-0.5 * slope / square, lower, std::max(lower, upper));
  }
};

Ask ask_of(const TimeWish& wish, double before, bool is_last) {
  Ask ask;
  if (wish.time_weight) {
    ask.square = *wish.time_weight;
    ask.slope = -2 * *wish.time_weight * (*wish.time - before);
  } else if (wish.time) {
    ask.lower = ask.upper = *wish.time - before;
  } else {
    ask.lower = wish.earliest.value_or(0) - before;
    ask.upper = wish.latest.value_or(kNever) - before;
  }
  if (is_last) ask.slope += 1;
  return ask;
}

// What all keyframes ask, with bounds that rise: none is earlier than the one before, or later than
// the one after. The first keyframe that can have none of its times, where there is one.
std::optional<std::size_t> list_asks(std::span<const TimeWish> wishes, std::span<const double> legs,
                                     std::vector<Ask>& asks) {
  double before = 0;
  for (std::size_t k = 0; k < wishes.size(); ++k) {
    if (k > 0) before += legs[k - 1];
    Ask ask = ask_of(wishes[k], before, k + 1 == wishes.size());
    ask.lower = std::max(ask.lower, k > 0 ? asks.back().lower : 0);
    if (k == 0) ask.upper = std::min(ask.upper, 0.0);  // the film begins in it
    if (ask.lower > ask.upper + kSame) return k;
    ask.upper = std::max(ask.upper, ask.lower);
    asks.push_back(ask);
  }
  for (std::size_t k = asks.size() - 1; k-- > 0;)
    asks[k].upper = std::max(asks[k].lower, std::min(asks[k].upper, asks[k + 1].upper));
  return {};
}

}  // namespace

KeyframeTimes cheapest_times(std::span<const TimeWish> wishes, std::span<const double> legs) {
  if (wishes.empty() || legs.size() + 1 != wishes.size())
    throw Error("cheapest_times: one leg fewer than keyframes is needed");
  std::vector<Ask> asks;
  if (const auto refused = list_asks(wishes, legs, asks)) return {.times = {}, .refused = refused};
  std::vector<Pool> pools;
  for (std::size_t k = 0; k < asks.size(); ++k) {
    pools.push_back({k, asks[k].lower, asks[k].upper, asks[k].square, asks[k].slope});
    while (pools.size() > 1 && pools[pools.size() - 2].best() > pools.back().best()) {
      const Pool later = pools.back();
      pools.pop_back();
      Pool& pool = pools.back();
      pool.lower = later.lower;  // the bounds rise
      pool.square += later.square;
      pool.slope += later.slope;
    }
  }
  std::vector<double> times(asks.size());
  double before = 0;
  std::size_t pool = 0;
  for (std::size_t k = 0; k < asks.size(); ++k) {
    if (k > 0) before += legs[k - 1];
    if (pool + 1 < pools.size() && pools[pool + 1].first == k) ++pool;
    times[k] = pools[pool].best() + before;
    if (wishes[k].time && !wishes[k].time_weight) times[k] = *wishes[k].time;
  }
  return {.times = std::move(times), .refused = std::nullopt};
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
