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
//
// Of a team: a view of T is on some tour that can reach it, and takes at least the least of what it
// takes there. All tours together have the sum of their rooms. One tour is a team of one.
#include "framework/view/tour_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

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

using Tours = std::vector<const TourProblem*>;

class Bound {
 public:
  explicit Bound(const Tours& tours) {
    std::map<int, double> least;  // s, by view that some tour reaches
    for (const TourProblem* tour : tours) {
      for (const int view : tour->reachable()) {
        const double seconds = least_seconds(*tour, view);
        const auto [known, is_new] = least.try_emplace(view, seconds);
        if (!is_new) known->second = std::min(known->second, seconds);
      }
      ends_.insert({tour->start(), tour->end()});
      room_ += room_between(*tour);
      if (tour->image_limit())
        images_ += std::max(0, *tour->image_limit() - (tour->loop() ? 1 : 2));
      else
        limited_ = false;
    }
    for (const auto& [view, seconds] : least) {
      reachable_.push_back(view);
      seconds_.push_back(seconds);
    }
  }

  const std::vector<int>& reachable() const { return reachable_; }

  double with(ScoreState& state) const {
    std::vector<Item> items;
    double ends = 0;
    for (std::size_t i = 0; i < reachable_.size(); ++i) {
      const int view = reachable_[i];
      const double gain = state.gain(view);
      if (gain <= 0) continue;
      if (ends_.contains(view)) {
        ends += gain;  // on every tour, and paid for
      } else {
        items.push_back({gain, seconds_[i]});
      }
    }
    double further = fractional_knapsack(items, room_);
    if (limited_) further = std::min(further, largest(items));
    return state.score() + ends + further;
  }

 private:
  double largest(std::vector<Item>& items) const {
    std::sort(items.begin(), items.end(), [](auto& a, auto& b) { return a.gain > b.gain; });
    const std::size_t count = std::min(items.size(), static_cast<std::size_t>(images_));
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += items[i].gain;
    return sum;
  }

  std::vector<int> reachable_;  // ascending
  std::vector<double> seconds_;
  std::set<int> ends_;
  double room_ = 0;
  int images_ = 0;       // between starts and ends
  bool limited_ = true;  // every tour has a limit of images
};

// The views in the order in which greedy would take them.
std::vector<int> by_gain(const ViewScore& score, const std::set<int>& different) {
  std::vector<std::pair<double, int>> open;
  ScoreState state(score);
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

double bound_with(const Tours& tours, std::span<const int> views) {
  ScoreState state(tours.front()->score());
  for (const int view : views) state.add(view);
  return Bound(tours).with(state);
}

double upper_bound(const Tours& tours, const std::set<int>& different) {
  const Bound bound(tours);
  const ViewScore& score = tours.front()->score();
  ScoreState state(score);
  double best = std::min(bound.with(state), tours.front()->score_of(bound.reachable()));
  const std::vector<int> order = by_gain(score, different);
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

Tours tours_of(const TeamProblem& problem) {
  Tours tours;
  for (int t = 0; t < problem.size(); ++t) tours.push_back(&problem.tour(t));
  return tours;
}

}  // namespace

double tour_bound_with(const TourProblem& problem, std::span<const int> views) {
  return bound_with({&problem}, views);
}

double tour_upper_bound(const TourProblem& problem, std::span<const int> walk) {
  return upper_bound({&problem}, {walk.begin(), walk.end()});
}

double team_bound_with(const TeamProblem& problem, std::span<const int> views) {
  return bound_with(tours_of(problem), views);
}

double team_upper_bound(const TeamProblem& problem, const Walks& walks) {
  std::set<int> different;
  for (const std::vector<int>& walk : walks) different.insert(walk.begin(), walk.end());
  return upper_bound(tours_of(problem), different);
}

}  // namespace lapwing
