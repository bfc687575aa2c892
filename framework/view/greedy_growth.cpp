// SPDX-License-Identifier: Apache-2.0
// How: lazy greedy insertion (Minoux 1978; thesis 2.4). `extra_` and `after_` have for every view
// the fewest seconds that it adds and the place in the walk. They are exact, and updated after each
// insertion. `known_` has the gain of a view when it was last evaluated. By submodularity gains
// only fall while the tour grows, so this is an upper bound.
//
// A step puts all views that fit on a heap, by known gain or by known gain per second. An entry on
// top that was not evaluated in this step is evaluated and put back. An entry on top that was
// evaluated in this step is the best, because all others are below it even with their upper bounds:
// it is inserted. With `patience` only so many views are evaluated, and then the best of these is
// taken. Equal promises go to the lower number, so that the result does not depend on the heap.
#include "framework/view/greedy_growth.h"

#include <algorithm>
#include <limits>

namespace lapwing {
namespace {

constexpr double kLeastSeconds = 1e-6;  // s: what lies on the way costs nothing, nearly

// Largest promise first, then the lower number.
struct Candidate {
  double promise = 0;
  int view = 0;
  bool fresh = false;  // evaluated in this round
  bool operator<(const Candidate& other) const {
    return promise != other.promise ? promise < other.promise : view > other.view;
  }
};

class Round {
 public:
  Round(WorkingTour& tour, std::vector<double>& known, const Growth& growth, TourWork& work)
      : tour_(tour), known_(known), growth_(growth), work_(work) {
    tour_.cheapest_places(extra_, after_);
  }

  // One view more; false when nothing fits any more, or the work ended.
  bool step(std::int64_t iterations) {
    open_.clear();
    const double room = tour_.room();
    for (int view = 0; view < static_cast<int>(known_.size()); ++view) {
      if (known_[view] <= 0 || extra_[view] > room || tour_.visits(view) > 0) continue;
      if (!growth_.lazy && !evaluate(view, iterations)) return false;
      open_.push_back({promise(view), view, !growth_.lazy});
    }
    std::make_heap(open_.begin(), open_.end());
    int patience = growth_.patience > 0 ? growth_.patience : std::numeric_limits<int>::max();
    while (!open_.empty()) {
      std::pop_heap(open_.begin(), open_.end());
      Candidate& best = open_.back();
      if (!best.fresh) {
        if (patience-- == 0) {
          take_best_fresh();
          continue;
        }
        if (!evaluate(best.view, iterations)) return false;
        best.promise = promise(best.view);
        best.fresh = true;
        if (known_[best.view] <= 0)
          open_.pop_back();
        else
          std::push_heap(open_.begin(), open_.end());
        continue;
      }
      const int view = best.view;
      open_.pop_back();
      if (known_[view] <= 0 || !tour_.admits(view, after_[view])) continue;
      const int at = after_[view], before = tour_.size();
      tour_.insert(view, at);
      tour_.update_places(at, tour_.size() - before, extra_, after_);
      return true;
    }
    return false;
  }

 private:
  bool evaluate(int view, std::int64_t iterations) {
    if (work_.ended(tour_.state().evaluations(), iterations)) return false;
    known_[view] = tour_.state().gain(view);
    return true;
  }

  double promise(int view) const {
    double value = known_[view];
    if (growth_.by_ratio) value /= std::max(extra_[view], kLeastSeconds);
    return growth_.favour.empty() ? value : value * growth_.favour[view];
  }

  // Only what was evaluated stays.
  void take_best_fresh() {
    std::erase_if(open_, [](const Candidate& c) { return !c.fresh; });
    std::make_heap(open_.begin(), open_.end());
  }

  WorkingTour& tour_;
  std::vector<double>& known_;
  const Growth& growth_;
  TourWork& work_;
  std::vector<double> extra_;
  std::vector<int> after_;
  std::vector<Candidate> open_;
};

}  // namespace

std::vector<double> gains_alone(const TourProblem& problem) {
  std::vector<double> gains(problem.views());
  for (int v = 0; v < problem.views(); ++v) gains[v] = problem.score().alone(v);
  return gains;
}

void grow(WorkingTour& tour, std::vector<double>& known, const Growth& growth, TourWork& work,
          std::int64_t iterations) {
  Round round(tour, known, growth, work);
  while (round.step(iterations)) {
  }
}

}  // namespace lapwing
