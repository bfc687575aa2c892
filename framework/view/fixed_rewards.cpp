// SPDX-License-Identifier: Apache-2.0
#include "framework/view/fixed_rewards.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace lapwing {
namespace {

constexpr double kNoTime = 1e-9;  // s

using ToursOfRewards = std::vector<const TourProblem*>;

// Per view the lowest view at the same place.
std::vector<int> places_of(const ToursOfRewards& tours) {
  std::vector<int> place(tours.front()->views());
  std::iota(place.begin(), place.end(), 0);
  if (tours.front()->each_once()) return place;
  const auto root = [&](int v) {
    while (place[v] != v) v = place[v] = place[place[v]];
    return v;
  };
  for (const TourProblem* tour : tours) {
    for (int a = 0; a < tour->views(); ++a) {
      const auto beside = tour->neighbours_of(a);
      for (std::size_t i = 0; i < beside.size(); ++i) {
        const int b = beside[i];
        const double stops = (tour->stop_seconds(a) + tour->stop_seconds(b)) / 2;
        if (tour->neighbour_legs_of(a)[i] - stops > kNoTime) continue;
        const int one = root(a), other = root(b);
        place[std::max(one, other)] = std::min(one, other);
      }
    }
  }
  for (int& of_view : place) of_view = root(of_view);
  return place;
}

FixedRewards fix_rewards(const ToursOfRewards& tours, const std::vector<int>& reachable,
                         TourWork& work) {
  const ViewScore& score = tours.front()->score();
  FixedRewards rewards;
  rewards.of_view.assign(score.views(), 0);
  const std::vector<int> place = places_of(tours);
  std::vector<int> choices(score.views(), 0);
  for (const int p : place) ++choices[p];
  rewards.places = static_cast<int>(
      std::count_if(choices.begin(), choices.end(), [](int count) { return count > 1; }));

  ScoreState state(score);
  std::vector<char> taken(score.views(), 0);
  const auto take = [&](int view, double gain) {
    rewards.of_view[view] = gain;
    state.add(view);
    taken[place[view]] = 1;
  };
  // Start and end are on every tour.
  std::set<int> ends;
  for (const TourProblem* tour : tours) ends.insert({tour->start(), tour->end()});
  for (const int view : ends) take(view, state.gain(view));
  std::vector<std::pair<double, int>> open;  // last known gain; lower numbers first
  for (const int view : reachable) {
    if (!taken[place[view]]) open.push_back({score.alone(view), -view});
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

}  // namespace

FixedRewards fix_rewards(const TourProblem& problem, TourWork& work) {
  return fix_rewards({&problem}, problem.reachable(), work);
}

FixedRewards fix_rewards(const TeamProblem& problem, TourWork& work) {
  ToursOfRewards tours;
  for (int t = 0; t < problem.size(); ++t) tours.push_back(&problem.tour(t));
  return fix_rewards(tours, problem.reachable(), work);
}

}  // namespace lapwing
