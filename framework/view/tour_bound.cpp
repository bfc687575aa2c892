// SPDX-License-Identifier: Apache-2.0
// How: the score f is monotone and submodular. For any set S and the best tour T therefore
//
//   f(T) <= f(S + T) <= f(S) + sum of f(v|S) over the views v of T
//
// (Nemhauser, Wolsey and Fisher 1978). What T can add to S is bounded by a knapsack: every view
// takes at least `least_seconds`, half of two legs, and all of T takes at most the budget. The
// fractional knapsack, filled by gain per second, is at least the integral one (Dantzig 1957). A
// limit of images bounds the sum by the largest gains too. Start and end are on every tour: their
// gains count, and their halves of legs come off the budget. Every S gives a bound; the empty set
// and parts of a good tour in greedy order are tried, and the smallest bound is taken. The score of
// all reachable views is one more.
#include "framework/view/tour_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace lapwing {
namespace {

// Shares of a tour, in the order of greedy gains, that serve as S.
constexpr double kShares[] = {0.1, 0.25, 0.5, 0.75, 1.0};

// The least of the budget that a view on a tour takes beside others: half of its two legs. Where
// views may be passed again both legs may be the same motion, there and back. Where they may not,
// they lead to two neighbours, unless the view is the only one of a loop.
double least_seconds(const TourProblem& problem, int view) {
  const auto [first, second] = problem.cheapest_legs(view);
  if (!problem.each_once()) return first;
  const double two = (first + second) / 2;
  return problem.loop() ? std::min(two, problem.leg(view, problem.start())) : two;
}

// What is left for views between start and end: those have a leg each (a loop's start has two).
double room_between(const TourProblem& problem) {
  const double ends = problem.cheapest_legs(problem.start()).first / 2 +
                      problem.cheapest_legs(problem.end()).first / 2;
  const double room = problem.budget() + problem.tolerance() - problem.fixed_seconds();
  return std::isfinite(ends) ? std::max(0.0, room - ends) : 0;
}

struct Item {
  double gain, seconds;
};

double fractional_knapsack(std::vector<Item> items, double room) {
  const auto denser = [](const Item& a, const Item& b) {
    return a.gain * b.seconds > b.gain * a.seconds;
  };
  std::sort(items.begin(), items.end(), denser);
  double value = 0;
  for (const Item& item : items) {
    if (item.seconds > room) return value + item.gain * room / item.seconds;
    value += item.gain;
    room -= item.seconds;
  }
  return value;
}

class Bound {
 public:
  explicit Bound(const TourProblem& problem)
      : problem_(problem), reachable_(problem.reachable()), room_(room_between(problem)) {
    for (const int view : reachable_) seconds_.push_back(least_seconds(problem, view));
  }

  const std::vector<int>& reachable() const { return reachable_; }

  double with(ScoreState& state) const {
    std::vector<Item> items;
    double ends = 0;
    for (std::size_t i = 0; i < reachable_.size(); ++i) {
      const int view = reachable_[i];
      const double gain = state.gain(view);
      if (gain <= 0) continue;
      if (view == problem_.start() || view == problem_.end()) {
        ends += gain;  // on every tour, and paid for
      } else {
        items.push_back({gain, seconds_[i]});
      }
    }
    double further = fractional_knapsack(items, room_);
    if (problem_.image_limit()) further = std::min(further, largest(items));
    return state.score() + ends + further;
  }

 private:
  double largest(std::vector<Item>& items) const {
    std::sort(items.begin(), items.end(), [](auto& a, auto& b) { return a.gain > b.gain; });
    const std::size_t ends = problem_.loop() ? 1 : 2;
    const std::size_t limit = static_cast<std::size_t>(*problem_.image_limit());
    const std::size_t count = std::min(items.size(), limit > ends ? limit - ends : 0);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += items[i].gain;
    return sum;
  }

  const TourProblem& problem_;
  std::vector<int> reachable_;
  std::vector<double> seconds_;
  double room_;
};

// The views of a walk, each once, in the order in which greedy would take them.
std::vector<int> by_gain(const TourProblem& problem, std::span<const int> walk) {
  const std::set<int> different(walk.begin(), walk.end());
  std::vector<std::pair<double, int>> open;
  ScoreState state(problem.score());
  for (const int view : different) open.push_back({state.gain(view), -view});
  std::make_heap(open.begin(), open.end());
  std::vector<int> order;
  while (!open.empty()) {
    std::pop_heap(open.begin(), open.end());
    auto& [gain, negative] = open.back();
    gain = state.gain(-negative);
    if (open.size() > 1 && std::pair(gain, negative) < open.front()) {
      std::push_heap(open.begin(), open.end());
      continue;
    }
    order.push_back(-negative);
    state.add(order.back());
    open.pop_back();
  }
  return order;
}

}  // namespace

double tour_bound_with(const TourProblem& problem, std::span<const int> views) {
  ScoreState state(problem.score());
  for (const int view : views) state.add(view);
  return Bound(problem).with(state);
}

double tour_upper_bound(const TourProblem& problem, std::span<const int> walk) {
  const Bound bound(problem);
  ScoreState state(problem.score());
  double best = std::min(bound.with(state), problem.score_of(bound.reachable()));
  const std::vector<int> order = by_gain(problem, walk);
  std::size_t taken = 0;
  for (const double share : kShares) {
    const auto count =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(order.size())));
    if (count == taken) continue;
    while (taken < count) state.add(order[taken++]);
    best = std::min(best, bound.with(state));
  }
  return best;
}

}  // namespace lapwing
