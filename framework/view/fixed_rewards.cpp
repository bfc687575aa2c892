// SPDX-License-Identifier: Apache-2.0
#include "framework/view/fixed_rewards.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace lapwing {
namespace {

constexpr double kNoTime = 1e-9;  // s

// Per view the lowest view at the same place.
std::vector<int> places_of(const TourProblem& problem) {
  std::vector<int> place(problem.views());
  std::iota(place.begin(), place.end(), 0);
  if (problem.each_once()) return place;
  const auto root = [&](int v) {
    while (place[v] != v) v = place[v] = place[place[v]];
    return v;
  };
  for (int a = 0; a < problem.views(); ++a) {
    const auto beside = problem.neighbours_of(a);
    for (std::size_t i = 0; i < beside.size(); ++i) {
      const int b = beside[i];
      const double stops = (problem.stop_seconds(a) + problem.stop_seconds(b)) / 2;
      if (problem.neighbour_legs_of(a)[i] - stops > kNoTime) continue;
      const int one = root(a), other = root(b);
      place[std::max(one, other)] = std::min(one, other);
    }
  }
  for (int v = 0; v < problem.views(); ++v) place[v] = root(v);
  return place;
}

}  // namespace

FixedRewards fix_rewards(const TourProblem& problem, TourWork& work) {
  FixedRewards rewards;
  rewards.of_view.assign(problem.views(), 0);
  const std::vector<int> place = places_of(problem);
  std::vector<int> choices(problem.views(), 0);
  for (const int p : place) ++choices[p];
  rewards.places = static_cast<int>(
      std::count_if(choices.begin(), choices.end(), [](int count) { return count > 1; }));

  ScoreState state(problem.score());
  std::vector<char> taken(problem.views(), 0);
  const auto take = [&](int view, double gain) {
    rewards.of_view[view] = gain;
    state.add(view);
    taken[place[view]] = 1;
  };
  // Start and end are on every tour.
  for (const int view : std::set<int>{problem.start(), problem.end()}) take(view, state.gain(view));
  std::vector<std::pair<double, int>> open;  // last known gain; lower numbers first
  for (const int view : problem.reachable()) {
    if (!taken[place[view]]) open.push_back({problem.score().alone(view), -view});
  }
  std::make_heap(open.begin(), open.end());
  while (!open.empty() && !work.ended(state.evaluations())) {
    std::pop_heap(open.begin(), open.end());
    auto& [gain, negative] = open.back();
    if (taken[place[-negative]]) {
      open.pop_back();
      continue;
    }
    gain = state.gain(-negative);
    if (open.size() > 1 && std::pair(gain, negative) < open.front()) {
      std::push_heap(open.begin(), open.end());
      continue;
    }
    if (gain <= 0) break;
    take(-negative, gain);
    open.pop_back();
  }
  rewards.evaluations = state.evaluations();
  return rewards;
}

}  // namespace lapwing
