// SPDX-License-Identifier: Apache-2.0
// One tour problem (thesis 4.1): which views to take, and in which order, within a budget.
//
// A tour is a walk: views in order, from `start` to `end`, neighbours joined by a motion. It costs
// the seconds of its motions and of its views. Views passed on the way are part of the tour: they
// cost, and they count (reading 4.4). Start and end cost once, however often they are passed; any
// other view costs at every visit, and counts once (reading 4.1).
//
// Half a view's seconds belong to each leg that touches it, so that what a walk costs is
//
//   seconds of start and end  +  sum of legs,   leg(a, b) = motion + (view(a) + view(b)) / 2
//
// with view(start) = view(end) = 0. `leg` between any two views is the shortest way through the
// motions, or, in a problem of `legs` (the orienteering problem), just the stated leg.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/view/view_score.h"

namespace lapwing {

// Between two views, both ways.
struct TourMotion {
  int a = 0, b = 0;
  double seconds = 0;
};

struct TourDefinition {
  std::shared_ptr<const ViewScore> score;  // one view each
  std::vector<double> view_seconds;        // per view; one entry serves all
  std::vector<TourMotion> motions;         // of several between two views the quickest counts
  // Instead of motions: row by row, symmetric, every view next to every other. Then legs are as
  // stated, no other view is passed on the way, and each view is visited at most once.
  std::vector<double> legs;
  int start = 0, end = 0;                         // equal: a loop
  double budget = 0;                              // s
  std::optional<int> image_limit = std::nullopt;  // most different views on the tour
};

// Immutable but for ways, which are searched when first asked for; thread-safe.
class TourProblem {
 public:
  // InputError with everything that is wrong.
  explicit TourProblem(TourDefinition definition);
  ~TourProblem();
  // The same views, ways, start and end, but another budget (s) and image limit: ways that one of
  // the two has searched are known to the other. InputError as above.
  TourProblem with_limits(double budget, std::optional<int> image_limit) const;
  TourProblem(TourProblem&&) noexcept;
  TourProblem& operator=(TourProblem&&) noexcept;

  int views() const { return score_->views(); }
  const ViewScore& score() const { return *score_; }
  int start() const { return start_; }
  int end() const { return end_; }
  bool loop() const { return start_ == end_; }
  double budget() const { return budget_; }
  const std::optional<int>& image_limit() const { return image_limit_; }
  // Whether legs were given: each view at most once, nothing passed on the way.
  bool each_once() const { return !legs_->empty(); }
  // Whether both have the same views, ways, start and end by construction (with_limits).
  bool same_ways(const TourProblem& other) const {
    return legs_ == other.legs_ && ways_ == other.ways_;
  }
  // What the views' motions lead to, ascending, and their legs; none in a problem of legs. Valid as
  // long as this object.
  std::span<const int> neighbours_of(int view) const {
    if (each_once()) return {};
    return std::span(neighbours_).subspan(first_neighbour_[view], degree(view));
  }
  std::span<const double> neighbour_legs_of(int view) const {
    if (each_once()) return {};
    return std::span(neighbour_legs_).subspan(first_neighbour_[view], degree(view));
  }
  // s: what a visit takes of its legs; 0 for start and end.
  double stop_seconds(int view) const { return stops_[view]; }
  // s: of the views at start and end, which every tour pays.
  double fixed_seconds() const { return fixed_seconds_; }

  // From `view` to every view, infinite where there is no way. Valid as long as this object.
  std::span<const double> legs_from(int view) const;
  double leg(int a, int b) const { return legs_from(a)[b]; }
  // s: likewise, past any views. Less than the leg where stated legs are not the quickest (rounded
  // distances, say), and then perhaps less than a tour needs that visits each view once.
  std::vector<double> least_seconds_from(int view) const;
  // Appends the views after `a` up to and including `b`; nothing where a is b. There is a way.
  // The same there and back.
  void append_way(int a, int b, std::vector<int>& walk) const;
  // The cheapest legs at a view: to its nearest neighbour, and to the next.
  std::pair<double, double> cheapest_legs(int view) const;

  // What is wrong with a walk, "" when it is a tour within the budget: "from view 3 to view 7
  // there is no motion". A loop begins and ends with its start, or is the start alone.
  std::string problem_of(std::span<const int> walk) const;
  // s; infinite where a leg is no motion.
  double seconds_of(std::span<const int> walk) const;
  double score_of(std::span<const int> walk) const;
  static int images_of(std::span<const int> walk);

  // Views from which start and end are near enough for the budget, start and end included, past any
  // views: a tour takes no others. Empty where not even the way from start to end is.
  std::vector<int> reachable() const;
  // Why there is no tour at all; "" where there is one.
  std::string why_infeasible() const;
  // What a walk may exceed the budget by: rounding alone.
  double tolerance() const { return 1e-9 * (1 + budget_); }

 private:
  struct Ways;
  TourProblem(const TourProblem&);
  double direct_leg(int a, int b) const;
  std::size_t degree(int view) const { return first_neighbour_[view + 1] - first_neighbour_[view]; }

  std::shared_ptr<const ViewScore> score_;
  std::shared_ptr<const std::vector<double>> legs_;
  std::vector<int> first_neighbour_{0}, neighbours_;  // by view, neighbours ascending
  std::vector<double> neighbour_legs_, stops_;
  int start_ = 0, end_ = 0;
  double budget_ = 0, fixed_seconds_ = 0;
  std::optional<int> image_limit_;
  std::shared_ptr<Ways> ways_;
};

}  // namespace lapwing
