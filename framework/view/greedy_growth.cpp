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
//
// Of several tours of a team each has its own places. A view is promised by the tour with room for
// it that it lengthens least, the first one of equal ones.
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
  Round(std::span<WorkingTour* const> tours, std::vector<double>& known, const GreedyGrowth& growth,
        TourWork& work)
      : tours_(tours),
        known_(known),
        growth_(growth),
        work_(work),
        places_(tours.size()),
        tour_for_(known.size(), 0) {
    for (std::size_t t = 0; t < tours.size(); ++t)
      tours[t]->cheapest_places(places_[t].extra, places_[t].after);
  }

  // One view more; false when nothing fits any more, or the work ended.
  bool step(std::int64_t iterations) {
    open_.clear();
    for (int view = 0; view < static_cast<int>(known_.size()); ++view) {
      if (known_[view] <= 0 || tours_.front()->taken(view) || !choose_tour(view)) continue;
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
      if (known_[view] > 0 && insert(view)) return true;
    }
    return false;
  }

 private:
  struct Places {
    std::vector<double> extra;
    std::vector<int> after;
  };

  bool evaluate(int view, std::int64_t iterations) {
    if (work_.ended(tours_.front()->state().evaluations(), iterations)) return false;
    known_[view] = tours_.front()->state().gain(view);
    return true;
  }

  // False where no tour has room for it.
  bool choose_tour(int view) {
    int chosen = -1;
    for (int t = 0; t < static_cast<int>(tours_.size()); ++t) {
      const double extra = places_[t].extra[view];
      if (extra > tours_[t]->room() || (tours_.size() > 1 && full(t))) continue;
      if (chosen < 0 || extra < places_[chosen].extra[view]) chosen = t;
    }
    if (chosen >= 0) tour_for_[view] = chosen;
    return chosen >= 0;
  }

  bool full(int tour) const {
    const auto& limit = tours_[tour]->problem().image_limit();
    return limit && tours_[tour]->images() >= *limit;
  }

  bool insert(int view) {
    WorkingTour& tour = *tours_[tour_for_[view]];
    Places& places = places_[tour_for_[view]];
    const int at = places.after[view], before = tour.size();
    if (!tour.admits(view, at)) return false;
    tour.insert(view, at);
    tour.update_places(at, tour.size() - before, places.extra, places.after);
    return true;
  }

  double promise(int view) const {
    double value = known_[view];
    if (growth_.by_ratio) value /= std::max(places_[tour_for_[view]].extra[view], kLeastSeconds);
    return growth_.favour.empty() ? value : value * growth_.favour[view];
  }

  // Only what was evaluated stays.
  void take_best_fresh() {
    std::erase_if(open_, [](const Candidate& c) { return !c.fresh; });
    std::make_heap(open_.begin(), open_.end());
  }

  std::span<WorkingTour* const> tours_;
  std::vector<double>& known_;
  const GreedyGrowth& growth_;
  TourWork& work_;
  std::vector<Places> places_;  // per tour
  std::vector<int> tour_for_;   // per view, of this step
  std::vector<Candidate> open_;
};

}  // namespace

std::vector<double> gains_alone(const TourProblem& problem) {
  std::vector<double> gains(problem.views());
  for (int v = 0; v < problem.views(); ++v) gains[v] = problem.score().alone(v);
  return gains;
}

void grow(std::span<WorkingTour* const> tours, std::vector<double>& known,
          const GreedyGrowth& growth, TourWork& work, std::int64_t iterations) {
  Round round(tours, known, growth, work);
  while (round.step(iterations)) {
  }
}

void grow(WorkingTour& tour, std::vector<double>& known, const GreedyGrowth& growth, TourWork& work,
          std::int64_t iterations) {
  WorkingTour* const alone[] = {&tour};
  grow(alone, known, growth, work, iterations);
}

}  // namespace lapwing
