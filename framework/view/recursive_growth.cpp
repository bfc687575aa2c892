// SPDX-License-Identifier: Apache-2.0
// How: part(list, a, b, B) appends the tour from view a to view b within B seconds.
//   1. Find the view m with the largest gain of those with leg(a, m) + leg(m, b) <= B. Gains only
//      shrink as the tour grows. So the list is sorted by old gains: the first possible entry is
//      evaluated anew and moved to its place; if it stays first, it is the best (lazy evaluation).
//   2. Without such an m, append the shortest way from a to b; the views on it count as seen.
//   3. Else solve part(a, m) with a share of B, limited by what leg(m, b) needs. Then solve
//      part(m, b) with all that is left; its gains include what the first part added.
// `list` is passed by value: each part starts from the gains known when it was split off.
// With a limit of images, visits_ counts how often each view is on the tour, with shortest ways for
// parts that are still open. A middle that would exceed the limit is not admitted.
#include "framework/view/recursive_growth.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

// The list of 4.7: views by descending gains, known from an earlier and smaller V.
struct Listed {
  double gain;
  int view;
};
using List = std::vector<Listed>;

bool before(const Listed& a, const Listed& b) {
  return a.gain != b.gain ? a.gain > b.gain : a.view < b.view;
}

class Recursion {
 public:
  Recursion(const TourProblem& problem, TourWork& work, std::int64_t evaluations, double share)
      : problem_(problem),
        work_(work),
        before_(evaluations),
        share_(share),
        state_(problem.score()),
        visits_(problem.views(), 0) {}

  std::vector<int> run() {
    state_.add(problem_.start());
    state_.add(problem_.end());
    List list;
    // Initially the gains over an empty V.
    for (const int view : problem_.reachable())
      list.push_back({problem_.score().alone(view), view});
    std::erase_if(list, [](const Listed& entry) { return entry.gain <= 0; });
    std::sort(list.begin(), list.end(), before);
    visit_way(problem_.start(), problem_.end(), 1);
    visits_[problem_.start()] += 1;
    walk_.push_back(problem_.start());
    const double room = problem_.budget() + problem_.tolerance() / 2 - problem_.fixed_seconds();
    part(list, problem_.start(), problem_.end(), room);
    return walk_;
  }

  ScoreState& state() { return state_; }
  std::int64_t parts() const { return parts_; }

 private:
  // Appends the tour after `from` up to and including `to`, in at most `budget` seconds, which
  // suffice for the way between them. Returns what it takes.
  double part(List list, int from, int to, double budget) {
    ++parts_;
    const int middle = best_between(list, from, to, budget);
    if (middle < 0) {
      std::vector<int> way;
      problem_.append_way(from, to, way);
      for (const int view : way) state_.add(view);
      walk_.insert(walk_.end(), way.begin(), way.end());
      return problem_.leg(from, to);
    }
    visit_way(from, to, -1);
    visit_way(from, middle, 1);
    visit_way(middle, to, 1);
    state_.add(middle);
    const double first_budget = std::max(
        problem_.leg(from, middle), std::min(share_ * budget, budget - problem_.leg(middle, to)));
    const double first = part(list, from, middle, first_budget);
    return first + part(std::move(list), middle, to, budget - first);
  }

  // The reachable view with the largest gain, by lazy evaluation; negative for none.
  int best_between(List& list, int from, int to, double budget) {
    const auto out = problem_.legs_from(from), on = problem_.legs_from(to);
    for (std::size_t i = 0; i < list.size();) {
      const int view = list[i].view;
      const bool possible = !state_.contains(view) && out[view] + on[view] <= budget &&
                            view != from && view != to && admits(from, view, to);
      if (!possible) {
        ++i;
        continue;
      }
      if (work_.ended(before_ + state_.evaluations())) return -1;
      list[i].gain = state_.gain(view);
      const auto here = list.begin() + static_cast<std::ptrdiff_t>(i);
      const auto place = std::upper_bound(here + 1, list.end(), *here, before);
      if (place == here + 1) {
        if (list[i].gain > 0) return view;
        ++i;
        continue;
      }
      std::rotate(here, here + 1, place);
    }
    return -1;
  }

  // The views after `from` up to `to` are once more, or once less, on the tour as it stands.
  void visit_way(int from, int to, int by) {
    if (!problem_.image_limit()) return;
    std::vector<int> way;
    problem_.append_way(from, to, way);
    for (const int view : way) visits_[view] += by;
  }

  bool admits(int from, int middle, int to) {
    if (!problem_.image_limit()) return true;
    visit_way(from, to, -1);
    visit_way(from, middle, 1);
    visit_way(middle, to, 1);
    const auto images = std::count_if(visits_.begin(), visits_.end(), [](int n) { return n > 0; });
    visit_way(middle, to, -1);
    visit_way(from, middle, -1);
    visit_way(from, to, 1);
    return images <= *problem_.image_limit();
  }

  const TourProblem& problem_;
  TourWork& work_;
  std::int64_t before_;
  double share_;
  ScoreState state_;
  std::vector<int> visits_;  // of the tour with shortest ways where parts are still open
  std::vector<int> walk_;
  std::int64_t parts_ = 0;
};

}  // namespace

RecursiveTour grow_recursively(const TourProblem& problem, TourWork& work, std::int64_t evaluations,
                               double share) {
  Recursion recursion(problem, work, evaluations, share);
  RecursiveTour tour;
  tour.walk = recursion.run();
  tour.score = recursion.state().score();
  tour.evaluations = recursion.state().evaluations();
  tour.parts = recursion.parts();
  return tour;
}

}  // namespace lapwing
