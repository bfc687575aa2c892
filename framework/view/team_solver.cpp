// SPDX-License-Identifier: Apache-2.0
// A solver's answer to a team problem: checked, compared with where it began, and bounded.
#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/view/tour_bound.h"
#include "framework/view/tour_solver.h"

namespace lapwing {
namespace {

constexpr double kTeamProven = 1e-9;  // of the bound: a gap of less is none

void report_walks(const TeamProblem& problem, const Walks& walks, TeamReport& report) {
  ScoreState state(problem.score());
  for (int t = 0; t < problem.size(); ++t) {
    const TourProblem& tour = problem.tour(t);
    report.tours.push_back({problem.name(t), tour.seconds_of(walks[t]), tour.budget(),
                            TourProblem::images_of(walks[t])});
    report.seconds_used += report.tours.back().seconds_used;
    for (const int view : walks[t]) state.add(view);
  }
  report.score = state.score();
  report.images = state.size();
}

}  // namespace

Value to_value(const TeamReport& report, const std::string& solver_name) {
  Value value = to_value(static_cast<const TourReport&>(report), solver_name);
  Value& tours = value.set("tours", Value::list());
  for (const TeamTourReport& tour : report.tours) {
    Value row = Value::map();
    row.set("name", tour.name);
    row.set("seconds", tour.seconds_used);
    row.set("budget", tour.budget);
    row.set("images", tour.images);
    tours.push_back(std::move(row));
  }
  return value;
}

TourSolver::TeamSearch TourSolver::search_team(const TeamProblem&, TourWork&, const Walks*) const {
  TeamSearch none;
  none.status = TourStatus::unsupported;
  none.message = "this solver plans one tour, not several that share one score";
  return none;
}

TeamResult TourSolver::solve(const TeamProblem& problem, const TeamRequest& request) const {
  TourWork work(request.limits);
  TeamResult result;
  TeamReport& report = result.report;
  const auto finish = [&](TourStatus status, std::string message) {
    report.status = status;
    report.message = std::move(message);
    report.wall_seconds = work.seconds();
    return result;
  };
  const auto broken = [&](const std::string& promise) {
    const char* const name = plugin_name();
    result.walks.clear();
    return finish(TourStatus::failed,
                  name ? plugin_failure(name, "search_team", promise).what() : promise);
  };
  try {
    report.upper_bound = std::numeric_limits<double>::infinity();
    const std::string hindrance = problem.why_infeasible();
    if (!hindrance.empty()) return finish(TourStatus::infeasible, hindrance);
    const std::vector<int> reachable = problem.reachable();
    report.reachable = static_cast<int>(reachable.size());
    report.reachable_score = problem.score_of({reachable});
    if (report.reachable_score <= 0)
      return finish(TourStatus::infeasible, "none of the " + std::to_string(reachable.size()) +
                                                " views within the budgets adds information");
    if (request.initial) {
      const std::string wrong = problem.problem_of(*request.initial);
      if (!wrong.empty())
        return finish(TourStatus::failed,
                      "the initial tours are not tours of this problem: " + wrong);
    }
    work.ended(0);
    TeamSearch searched = in_plugin(
        *this, "search_team",
        [&] { return search_team(problem, work, request.initial ? &*request.initial : nullptr); },
        CallLength::lengthy);
    if (work.ending() && searched.status == TourStatus::feasible) searched.status = *work.ending();
    report.evaluations = searched.evaluations;
    report.iterations = searched.iterations;
    if (!searched.walks.empty()) {
      const std::string wrong = problem.problem_of(searched.walks);
      if (!wrong.empty()) return broken("the result of the solver is no set of tours: " + wrong);
    }
    result.walks = std::move(searched.walks);
    if (request.initial && (result.walks.empty() ||
                            problem.score_of(result.walks) < problem.score_of(*request.initial))) {
      result.walks = *request.initial;
      searched.message += "; the initial tours are better and are kept";
    }
    if (result.walks.empty()) {
      if (searched.status == TourStatus::feasible) return broken("the solver returned no tours");
      return finish(searched.status, searched.message);
    }
    report_walks(problem, result.walks, report);
    if (report.score <= 0 && searched.status == TourStatus::feasible) {
      result.walks.clear();
      return finish(TourStatus::infeasible,
                    "no view with information fits into the budgets: " + searched.message);
    }
    if (request.limits.bound) report.upper_bound = team_upper_bound(problem, result.walks);
    if (searched.upper_bound)
      report.upper_bound = std::min(report.upper_bound, *searched.upper_bound);
    const double missing = report.upper_bound - report.score;
    report.gap = std::isfinite(missing) ? std::max(0.0, missing / report.upper_bound) : 1;
    const bool proven = report.gap <= kTeamProven && searched.status != TourStatus::cancelled;
    return finish(proven ? TourStatus::optimal : searched.status, searched.message);
  } catch (const std::exception& error) {
    result.walks.clear();
    return finish(TourStatus::failed, error.what());
  }
}

}  // namespace lapwing
