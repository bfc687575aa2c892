// SPDX-License-Identifier: Apache-2.0
// The published rival: rewards of views taken to be independent, then the best tour for their sum,
// as a mixed-integer linear program for CBC (thesis 4.5.2, 4.9.1; Roberts et al., ICCV 2017).
//
//   tour: {solver: milp, candidates: 1000}
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "framework/plugin/plugin.h"
#include "framework/view/fixed_rewards.h"
#include "framework/view/greedy_growth.h"
#include "plugins/tour_solvers/milp/tour_program.h"

namespace lapwing {
namespace {

constexpr double kSlack = 1e-6;      // of a start that CBC is to accept
constexpr double kTolerance = 1e-4;  // of CBC's bound

// The same tours, but the score is the sum of rewards.
TourProblem additive_problem(const TourProblem& problem, const std::vector<double>& rewards) {
  const int n = problem.views();
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(additive_score(rewards));
  d.view_seconds.assign(n, 0);  // legs hold them
  for (int v = 0; v < n && problem.each_once(); ++v) {
    const auto legs = problem.legs_from(v);
    d.legs.insert(d.legs.end(), legs.begin(), legs.end());
  }
  for (int v = 0; v < n && !problem.each_once(); ++v) {
    const auto beside = problem.neighbours_of(v);
    const auto legs = problem.neighbour_legs_of(v);
    for (std::size_t i = 0; i < beside.size(); ++i) {
      if (v < beside[i]) d.motions.push_back({v, beside[i], legs[i]});
    }
  }
  d.start = problem.start();
  d.end = problem.end();
  d.budget = std::max(0.0, problem.budget() - problem.fixed_seconds());
  d.image_limit = problem.image_limit();
  return TourProblem(std::move(d));
}

class Milp final : public TourSolver {
 public:
  static constexpr PluginText kText{"milp", "1.0.0",
                                    "best tour for a sum of fixed rewards, by integer programming",
                                    "Roberts et al. 2017; thesis 4.5.2, 4.9.1"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .integer("candidates", 1000,
                 "number of views in the program, those with the largest rewards",
                 between(1, 100'000))
        .integer("neighbours", 12, "arcs per view, the shortest in time; 0: all",
                 between(0, 100'000))
        .integer("nodes", 1000, "largest number of nodes of the search tree",
                 between(1, 100'000'000))
        .boolean("start", true, "start with a greedy tour for the same rewards");
  }
  explicit Milp(const Parameters& parameters)
      : candidates_(parameters.integer("candidates")),
        neighbours_(static_cast<int>(parameters.integer("neighbours"))),
        nodes_(static_cast<int>(parameters.integer("nodes"))),
        start_(parameters.boolean("start")) {}

 protected:
  Search search(const TourProblem& problem, TourWork& work) const override {
    FixedRewards rewards = fix_rewards(problem, work);
    const std::vector<int> chosen = choose(problem, rewards.of_view);
    const TourProblem additive = additive_problem(problem, rewards.of_view);
    Search result;
    result.evaluations = rewards.evaluations;
    std::vector<int> best = begin(problem, additive, work, result.evaluations);
    const TourProgram tours(problem, rewards.of_view, chosen, neighbours_, best);
    if (work.ended(result.evaluations)) {
      result.walk = std::move(best);
      result.status = *work.ending();
      result.message = "ended before the integer program";
      return result;
    }

    IntegerSearch how;
    how.nodes = nodes_;
    how.seed = static_cast<int>(work.request().seed % 1'000'000'007);
    how.ended = [&](std::int64_t nodes) { return work.ended(result.evaluations, nodes); };
    if (const auto& guard = work.request().wall_clock_guard) {
      how.seconds_left = *guard - work.seconds();
    }
    if (!best.empty()) how.start = tours.point_of(best);
    if (!how.start.empty() && tours.program().violation(how.start) > kSlack) how.start.clear();
    const IntegerResult found = solve_program(tours.program(), how);
    result.iterations = found.nodes;
    if (!found.x.empty()) {
      std::vector<int> walk = tours.walk_of(found.x);
      // What CBC takes to be within its tolerances need not be within ours.
      const bool sound = problem.problem_of(walk).empty();
      const bool better = best.empty() || additive.score_of(walk) >= additive.score_of(best);
      if (sound && better) best = std::move(walk);
    }
    work.ended(result.evaluations, result.iterations);
    say(problem, additive, rewards, tours, found, best, result);
    result.walk = std::move(best);
    if (work.ending()) result.status = *work.ending();
    return result;
  }

 private:
  // The views of largest reward, with start and end, ascending.
  std::vector<int> choose(const TourProblem& problem, std::vector<double>& rewards) const {
    std::vector<int> order;
    for (int v = 0; v < problem.views(); ++v) {
      if (rewards[v] > 0 && v != problem.start() && v != problem.end()) order.push_back(v);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return rewards[a] > rewards[b]; });
    const auto most = std::min<std::size_t>(order.size(), static_cast<std::size_t>(candidates_));
    for (std::size_t i = most; i < order.size(); ++i) rewards[order[i]] = 0;
    order.resize(most);
    std::set<int> chosen(order.begin(), order.end());
    chosen.insert({problem.start(), problem.end()});
    return {chosen.begin(), chosen.end()};
  }

  // The best tour for the sum of rewards before any program: greedy ones, or the initial tour.
  std::vector<int> begin(const TourProblem& problem, const TourProblem& additive, TourWork& work,
                         std::int64_t& evaluations) const {
    std::vector<int> best;
    double best_sum = -1;
    const auto take = [&](std::vector<int> walk) {
      if (!problem.problem_of(walk).empty() || additive.score_of(walk) <= best_sum) return;
      best_sum = additive.score_of(walk);
      best = std::move(walk);
    };
    if (work.request().initial) take(*work.request().initial);
    for (const bool by_ratio : {true, false}) {
      if (!start_) break;
      WorkingTour tour(additive);
      tour.state().set_evaluations(evaluations);
      std::vector<double> known = gains_alone(additive);
      grow(tour, known, {.by_ratio = by_ratio}, work);
      // What a shorter order leaves is filled again.
      while (tour.shorten()) {
        const int before = tour.images();
        grow(tour, known, {.by_ratio = by_ratio}, work);
        if (tour.images() == before) break;
      }
      evaluations = tour.state().evaluations();
      take(tour.finished());
    }
    return best;
  }

  void say(const TourProblem& problem, const TourProblem& additive, const FixedRewards& rewards,
           const TourProgram& tours, const IntegerResult& found, const std::vector<int>& best,
           Search& result) const {
    const int nodes = found.nodes;
    const std::string size = std::to_string(tours.program().columns()) + " columns, " +
                             std::to_string(tours.program().rows()) + " rows, " +
                             std::to_string(nodes) + " nodes";
    if (best.empty()) {
      // The way from start to end alone is a tour: a program without any knows too few arcs.
      result.status = TourStatus::iteration_limit;
      result.message = std::string("no tour found") +
                       (found.infeasible ? ", as the kept arcs connect none (" : " (") + size + ")";
      return;
    }
    const double sum = additive.score_of(best);
    char text[160];
    std::snprintf(text, sizeof text, "%s for the sum of rewards: %.6g of at most %.6g (",
                  found.optimal ? "the best tour" : "a tour", sum, std::max(sum, found.bound));
    result.message = text + size + ")";
    if (!counts_all(problem, rewards, tours) || !std::isfinite(found.bound)) return;
    const bool whole = std::all_of(rewards.of_view.begin(), rewards.of_view.end(),
                                   [](double reward) { return reward == std::floor(reward); });
    const double bound = found.bound + kTolerance * (1 + std::abs(found.bound));
    result.upper_bound = whole ? std::floor(bound) : bound;
  }

  // Whether rewards are the score itself, and the program holds every tour: then CBC's bound is
  // one.
  static bool counts_all(const TourProblem& problem, const FixedRewards& rewards,
                         const TourProgram& tours) {
    if (!tours.complete() || rewards.places > 0 || problem.image_limit()) return false;
    double alone = 0, counted = 0, reachable = 0;
    for (int v = 0; v < problem.views(); ++v) {
      alone += problem.score().alone(v);
      counted += rewards.of_view[v];
    }
    for (const int v : problem.reachable()) reachable += problem.score().alone(v);
    return alone == problem.score().total() && counted == reachable;
  }

  std::int64_t candidates_;
  int neighbours_, nodes_;
  bool start_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Milp)
