// SPDX-License-Identifier: Apache-2.0
// The recursive greedy algorithm of the thesis (algorithm 2): see recursive_growth.h.
//
// Further rounds divide the budget elsewhere than in the middle, at random; the best round counts.
//
//   tour: {solver: recursive_greedy}
#include "framework/core/random.h"
#include "framework/plugin/plugin.h"
#include "framework/view/recursive_growth.h"

namespace lapwing {
namespace {

constexpr double kLeastShare = 0.25, kLargestShare = 0.75;  // of a part's budget, before its middle

class RecursiveGreedy final : public TourSolver {
 public:
  static constexpr PluginText kText{"recursive_greedy", "1.0.0",
                                    "best middle view first, then both halves recursively",
                                    "thesis algorithm 2, 4.7; reading 4.4"};
  static ParameterTable parameters() {
    return ParameterTable{}.integer(
        "rounds", 1,
        "number of runs; the first halves budgets as in the thesis, others divide at random",
        between(1, 1'000'000));
  }
  explicit RecursiveGreedy(const Parameters& parameters) : rounds_(parameters.integer("rounds")) {}

 protected:
  Search search(const TourProblem& problem, TourWork& work) const override {
    Random random(work.request().seed);
    Search result;
    double best = -1, share = 0.5;
    for (std::int64_t round = 0; round < rounds_; ++round) {
      RecursiveTour tour = grow_recursively(problem, work, result.evaluations, share);
      result.evaluations += tour.evaluations;
      result.iterations += tour.parts;
      if (tour.score > best) {
        best = tour.score;
        result.walk = std::move(tour.walk);
      }
      if (work.ended(result.evaluations)) break;
      share = random.uniform(kLeastShare, kLargestShare);
    }
    result.status = work.ending().value_or(TourStatus::feasible);
    result.message =
        work.ending() ? "ended early, the best so far" : "no view with a gain fits into any part";
    return result;
  }

 private:
  std::int64_t rounds_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::RecursiveGreedy)
