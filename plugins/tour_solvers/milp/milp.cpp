// SPDX-License-Identifier: Apache-2.0
// The published rival: rewards of views taken to be independent, then the best tour for their sum,
// as a mixed-integer linear program for CBC (thesis 4.5.2, 4.9.1; Roberts et al., ICCV 2017).
//
//   tour: {solver: milp, candidates: 1000}
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "framework/plugin/plugin.h"
#include "framework/view/fixed_rewards.h"
#include "framework/view/greedy_growth.h"
#include "framework/view/working_team.h"
#include "plugins/tour_solvers/milp/team_program.h"
#include "plugins/tour_solvers/milp/tour_program.h"

namespace lapwing {
namespace {

constexpr double kSlack = 1e-6;      // of a start that CBC is to accept
constexpr double kTolerance = 1e-4;  // of CBC's bound
// Of a program of several tours: beyond, the first linear program alone takes hours.
constexpr std::int64_t kMostColumns = 500'000;

using SharedScore = std::shared_ptr<const ViewScore>;

SharedScore sum_of(const std::vector<double>& rewards) {
  return std::make_shared<const ViewScore>(additive_score(rewards));
}

// The same tours, but the score is the sum of rewards.
TourProblem additive_problem(const TourProblem& problem, SharedScore sum) {
  const int n = problem.views();
  TourDefinition d;
  d.score = std::move(sum);
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

TeamProblem additive_problem(const TeamProblem& problem, const std::vector<double>& rewards) {
  const SharedScore sum = sum_of(rewards);
  std::vector<TeamTour> tours;
  for (int t = 0; t < problem.size(); ++t) {
    const TourProblem& own = problem.tour(t);
    // Moves between tours need to know that these have the same ways.
    int same = 0;
    while (same < t && !own.same_ways(problem.tour(same))) ++same;
    const double budget = std::max(0.0, own.budget() - own.fixed_seconds());
    tours.push_back(
        {problem.name(t), same < t ? tours[same].problem.with_limits(budget, own.image_limit())
                                   : additive_problem(own, sum)});
  }
  return TeamProblem(std::move(tours));
}

std::string size_of(const IntegerProgram& program, int nodes) {
  return std::to_string(program.columns()) + " columns, " + std::to_string(program.rows()) +
         " rows, " + std::to_string(nodes) + " nodes";
}

// What was found and proven: "the best tours for the sum of rewards: 18 of at most 18 (".
std::string verdict(const char* what, double sum, const IntegerResult& found) {
  char text[160];
  std::snprintf(text, sizeof text, "%s for the sum of rewards: %.6g of at most %.6g (", what, sum,
                std::max(sum, found.bound));
  return text;
}

// No tours score more, where rewards are the score itself.
double bound_of(const FixedRewards& rewards, const IntegerResult& found) {
  const bool whole = std::all_of(rewards.of_view.begin(), rewards.of_view.end(),
                                 [](double reward) { return reward == std::floor(reward); });
  const double bound = found.bound + kTolerance * (1 + std::abs(found.bound));
  return whole ? std::floor(bound) : bound;
}

// Whether the sum of rewards is the score of every set of views that can be reached.
bool independent(const ViewScore& score, const std::vector<int>& within,
                 const FixedRewards& rewards) {
  if (rewards.places > 0) return false;
  double alone = 0, counted = 0, reachable = 0;
  for (int v = 0; v < score.views(); ++v) {
    alone += score.alone(v);
    counted += rewards.of_view[v];
  }
  for (const int v : within) reachable += score.alone(v);
  return alone == score.total() && counted == reachable;
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
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kTakesTeams, nullptr}};
    return all;
  }
  explicit Milp(const Parameters& parameters)
      : candidates_(parameters.integer("candidates")),
        neighbours_(static_cast<int>(parameters.integer("neighbours"))),
        nodes_(static_cast<int>(parameters.integer("nodes"))),
        start_(parameters.boolean("start")) {}

 protected:
  Search search(const TourProblem& problem, TourWork& work) const override {
    FixedRewards rewards = fix_rewards(problem, work);
    LeftOut left_out;
    const std::vector<int> chosen =
        choose({problem.start(), problem.end()}, rewards.of_view, left_out);
    const TourProblem additive = additive_problem(problem, sum_of(rewards.of_view));
    Search result;
    result.evaluations = rewards.evaluations;
    std::vector<int> best = begin(problem, additive, work, result.evaluations);
    TourProgram tours(problem, chosen, neighbours_, {best});
    IntegerProgram program;
    tours.write(program, &rewards.of_view);
    if (work.ended(result.evaluations)) {
      result.walk = std::move(best);
      result.status = *work.ending();
      result.message = "ended before the integer program";
      return result;
    }

    std::vector<double> start;
    if (!best.empty()) {
      start.assign(program.columns(), 0);
      if (!tours.put(best, start)) start.clear();
    }
    const IntegerResult found = solve(program, std::move(start), work, result.evaluations);
    result.iterations = found.nodes;
    if (!found.x.empty()) {
      std::vector<int> walk = std::move(tours.walks_of(found.x).front());
      // What CBC takes to be within its tolerances need not be within ours.
      const bool sound = problem.problem_of(walk).empty();
      const bool better = best.empty() || additive.score_of(walk) >= additive.score_of(best);
      if (sound && better) best = std::move(walk);
    }
    work.ended(result.evaluations, result.iterations);
    left_out.arcs = !tours.complete();
    // This may take time cubic in the views, and without all arcs nothing is proven anyway.
    left_out.shortcuts = !left_out.arcs && !holds_shortcuts(problem, tours.chosen());
    say(problem, additive, rewards, left_out, program, found, best, result);
    result.message += said(left_out);
    result.walk = std::move(best);
    if (work.ending()) result.status = *work.ending();
    return result;
  }

  TeamSearch search_team(const TeamProblem& problem, TourWork& work,
                         const Walks* initial) const override {
    FixedRewards rewards = fix_rewards(problem, work);
    std::set<int> ends;
    for (int t = 0; t < problem.size(); ++t)
      ends.insert({problem.tour(t).start(), problem.tour(t).end()});
    LeftOut left_out;
    const std::vector<int> chosen = choose(ends, rewards.of_view, left_out);
    const TeamProblem additive = additive_problem(problem, rewards.of_view);
    TeamSearch result;
    result.evaluations = rewards.evaluations;
    Walks best = begin(problem, additive, work, initial, result.evaluations);
    const auto ended_early = [&] {
      result.walks = std::move(best);
      result.status = *work.ending();
      result.message = "ended before the integer program";
      return result;
    };
    if (work.ended(result.evaluations)) return ended_early();
    TeamProgram team(problem, rewards.of_view, chosen, neighbours_, best);
    if (team.columns() > kMostColumns) {
      result.status = TourStatus::unsupported;
      result.message = "the integer program of " + std::to_string(problem.size()) + " tours and " +
                       std::to_string(chosen.size()) + " views has " +
                       std::to_string(team.columns()) + " columns, more than " +
                       std::to_string(kMostColumns) +
                       ": lower the parameters candidates or neighbours, or use local_search";
      return result;
    }
    team.write();
    if (work.ended(result.evaluations)) return ended_early();
    std::vector<double> start;
    if (!best.empty()) start = team.point_of(best);
    const IntegerResult found = solve(team.program(), std::move(start), work, result.evaluations);
    result.iterations = found.nodes;
    if (!found.x.empty()) {
      Walks walks = team.walks_of(found.x);
      const bool sound = problem.problem_of(walks).empty();
      const bool better = best.empty() || additive.score_of(walks) >= additive.score_of(best);
      if (sound && better) best = std::move(walks);
    }
    work.ended(result.evaluations, result.iterations);
    say(problem, additive, rewards, team, found, best, result);
    left_out.shortcuts = !team.has_all_shortcuts();
    left_out.arcs = !team.has_all_arcs();
    result.message += said(left_out);
    result.walks = std::move(best);
    if (work.ending()) result.status = *work.ending();
    return result;
  }

 private:
  IntegerResult solve(const IntegerProgram& program, std::vector<double> start, TourWork& work,
                      std::int64_t evaluations) const {
    IntegerSearch how;
    how.nodes = nodes_;
    how.seed = static_cast<int>(work.request().seed % 1'000'000'007);
    how.ended = [&work, evaluations](std::int64_t nodes) { return work.ended(evaluations, nodes); };
    if (const auto& guard = work.request().wall_clock_guard) {
      how.seconds_left = *guard - work.seconds();
    }
    how.start = std::move(start);
    if (!how.start.empty() && program.violation(how.start) > kSlack) how.start.clear();
    return solve_program(program, how);
  }

  // What of a problem its program does not hold.
  struct LeftOut {
    std::size_t views = 0, of = 0;  // with a reward
    bool shortcuts = false, arcs = false;
  };

  std::string said(const LeftOut& left_out) const {
    std::string text;
    if (left_out.views > 0)
      text += "; left out for less reward: " + std::to_string(left_out.views) + " of " +
              std::to_string(left_out.of) + " views";
    if (left_out.shortcuts) text += "; views without a reward that shorten ways are left out";
    if (left_out.arcs)
      text +=
          "; arcs to all but the " + std::to_string(neighbours_) + " nearest views are left out";
    return text;
  }

  // The views of largest reward, with starts and ends, ascending.
  std::vector<int> choose(const std::set<int>& ends, std::vector<double>& rewards,
                          LeftOut& left_out) const {
    std::vector<int> order;
    for (int v = 0; v < static_cast<int>(rewards.size()); ++v) {
      if (rewards[v] > 0 && !ends.contains(v)) order.push_back(v);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return rewards[a] > rewards[b]; });
    const auto most = std::min<std::size_t>(order.size(), static_cast<std::size_t>(candidates_));
    for (std::size_t i = most; i < order.size(); ++i) rewards[order[i]] = 0;
    left_out.of = order.size();
    left_out.views = order.size() - most;
    order.resize(most);
    std::set<int> chosen(order.begin(), order.end());
    chosen.insert(ends.begin(), ends.end());
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

  // Likewise of a team.
  Walks begin(const TeamProblem& problem, const TeamProblem& additive, TourWork& work,
              const Walks* initial, std::int64_t& evaluations) const {
    Walks best;
    double best_sum = -1;
    const auto take = [&](Walks walks) {
      if (!problem.problem_of(walks).empty() || additive.score_of(walks) <= best_sum) return;
      best_sum = additive.score_of(walks);
      best = std::move(walks);
    };
    if (initial) take(*initial);
    for (const bool by_ratio : {true, false}) {
      if (!start_) break;
      WorkingTeam team(additive);
      team.state().set_evaluations(evaluations);
      std::vector<double> known = gains_alone(additive.tour(0));
      team.grow_all(known, {.by_ratio = by_ratio}, work);
      while (team.shorten()) {
        const int before = team.images();
        team.grow_all(known, {.by_ratio = by_ratio}, work);
        if (team.images() == before) break;
      }
      evaluations = team.state().evaluations();
      take(team.finished());
    }
    return best;
  }

  // The way from start to end alone is a tour: a program without any knows too few arcs.
  static std::string nothing_found(const IntegerResult& found, const std::string& size) {
    return std::string(found.infeasible ? ", as the kept arcs connect none (" : " (") + size + ")";
  }

  void say(const TourProblem& problem, const TourProblem& additive, const FixedRewards& rewards,
           const LeftOut& left_out, const IntegerProgram& program, const IntegerResult& found,
           const std::vector<int>& best, Search& result) const {
    const std::string size = size_of(program, found.nodes);
    if (best.empty()) {
      result.status = TourStatus::iteration_limit;
      result.message = "no tour found" + nothing_found(found, size);
      return;
    }
    result.message =
        verdict(found.optimal ? "the best tour" : "a tour", additive.score_of(best), found) + size +
        ")";
    // The program holds every tour: then CBC's bound is one.
    if (left_out.arcs || left_out.shortcuts || problem.image_limit()) return;
    if (!std::isfinite(found.bound)) return;
    if (independent(problem.score(), problem.reachable(), rewards))
      result.upper_bound = bound_of(rewards, found);
  }

  void say(const TeamProblem& problem, const TeamProblem& additive, const FixedRewards& rewards,
           const TeamProgram& team, const IntegerResult& found, const Walks& best,
           TeamSearch& result) const {
    const std::string size = size_of(team.program(), found.nodes);
    if (best.empty()) {
      result.status = TourStatus::iteration_limit;
      result.message = "no tours found" + nothing_found(found, size);
      return;
    }
    result.message =
        verdict(found.optimal ? "the best tours" : "tours", additive.score_of(best), found) + size +
        ")";
    // Views that a way passes count for a limit of images as often as they are passed.
    bool limited = false;
    for (int t = 0; t < problem.size(); ++t)
      limited = limited || (problem.tour(t).image_limit() && !problem.tour(t).each_once());
    if (!team.has_all_arcs() || !team.has_all_shortcuts() || limited) return;
    if (!std::isfinite(found.bound)) return;
    if (independent(problem.score(), problem.reachable(), rewards))
      result.upper_bound = bound_of(rewards, found);
  }

  std::int64_t candidates_;
  int neighbours_, nodes_;
  bool start_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Milp)
