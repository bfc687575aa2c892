// SPDX-License-Identifier: Apache-2.0
#include "framework/view/tour_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/view/tour_bound.h"

namespace lapwing {
namespace {

constexpr double kProven = 1e-9;  // of the bound: a gap of less is none
constexpr int kClockEvery = 16;   // asks of the work between looks at the clock

}  // namespace

const char* to_string(TourStatus status) {
  switch (status) {
    case TourStatus::optimal:
      return "optimal";
    case TourStatus::feasible:
      return "feasible";
    case TourStatus::infeasible:
      return "infeasible";
    case TourStatus::iteration_limit:
      return "iteration_limit";
    case TourStatus::time_limit:
      return "time_limit";
    case TourStatus::cancelled:
      return "cancelled";
    case TourStatus::unsupported:
      return "unsupported";
    case TourStatus::failed:
      break;
  }
  return "failed";
}

Value to_value(const TourReport& report, const std::string& solver_name) {
  Value value = Value::map();
  value.set("name", solver_name);
  value.set("status", to_string(report.status));
  value.set("message", report.message);
  value.set("score", report.score);
  value.set("seconds", report.seconds_used);
  value.set("images", report.images);
  value.set("reachable", report.reachable);
  value.set("reachable_score", report.reachable_score);
  if (std::isfinite(report.upper_bound)) {
    value.set("upper_bound", report.upper_bound);
    value.set("gap", report.gap);
  }
  value.set("evaluations", report.evaluations);
  value.set("iterations", report.iterations);
  return value;
}

TourWork::TourWork(const TourRequest& request)
    : request_(&request), began_(std::chrono::steady_clock::now()) {}

double TourWork::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

bool TourWork::ended(std::int64_t evaluations, std::int64_t iterations) {
  show_activity();
  if (ending_) return true;
  const bool now = asked_++ % kClockEvery == 0;
  if (now && request_->progress) {
    double share = share_used(evaluations, iterations);
    if (expected_ > 0)
      share = std::max(share, static_cast<double>(iterations) / static_cast<double>(expected_));
    request_->progress->report(share > 0 ? std::min(1.0, share) : -1,
                               "tour: " + std::to_string(evaluations) + " gains computed");
  }
  if (request_->cancellation && request_->cancellation->cancelled()) {
    ending_ = TourStatus::cancelled;
  } else if ((request_->evaluation_limit && evaluations >= *request_->evaluation_limit) ||
             (request_->iteration_limit && iterations >= *request_->iteration_limit)) {
    ending_ = TourStatus::iteration_limit;
  } else if (now && request_->wall_clock_guard && seconds() >= *request_->wall_clock_guard) {
    ending_ = TourStatus::time_limit;
  }
  return ending_.has_value();
}

double TourWork::share_used(std::int64_t evaluations, std::int64_t iterations) const {
  double share = 0;
  const auto take = [&](std::int64_t done, const std::optional<std::int64_t>& limit) {
    if (limit) share = std::max(share, static_cast<double>(done) / std::max<double>(1, *limit));
  };
  take(evaluations, request_->evaluation_limit);
  take(iterations, request_->iteration_limit);
  return std::min(1.0, share);
}

TourResult TourSolver::solve(const TourProblem& problem, const TourRequest& request) const {
  TourWork work(request);
  TourResult result;
  TourReport& report = result.report;
  const auto finish = [&](TourStatus status, std::string message) {
    report.status = status;
    report.message = std::move(message);
    report.wall_seconds = work.seconds();
    return result;
  };
  const auto broken = [&](const std::string& promise) {
    const char* const name = plugin_name();
    return finish(TourStatus::failed,
                  name ? plugin_failure(name, "search", promise).what() : promise);
  };
  try {
    report.upper_bound = std::numeric_limits<double>::infinity();
    const std::string hindrance = problem.why_infeasible();
    if (!hindrance.empty()) return finish(TourStatus::infeasible, hindrance);
    const std::vector<int> reachable = problem.reachable();
    report.reachable = static_cast<int>(reachable.size());
    report.reachable_score = problem.score_of(reachable);
    if (report.reachable_score <= 0) {
      return finish(TourStatus::infeasible, "none of the " + std::to_string(reachable.size()) +
                                                " views within the budget adds information");
    }
    if (request.initial) {
      const std::string wrong = problem.problem_of(*request.initial);
      if (!wrong.empty()) {
        return finish(TourStatus::failed,
                      "the initial tour is not a tour of this problem: " + wrong);
      }
    }
    work.ended(0);  // cancelled or out of time before it began: the search says what it has
    Search searched = in_plugin(
        *this, "search", [&] { return search(problem, work); }, CallLength::lengthy);
    if (work.ending() && searched.status == TourStatus::feasible) searched.status = *work.ending();
    report.evaluations = searched.evaluations;
    report.iterations = searched.iterations;
    if (!searched.walk.empty()) {
      const std::string wrong = problem.problem_of(searched.walk);
      if (!wrong.empty()) return broken("the result of the solver is not a tour: " + wrong);
    }
    result.walk = std::move(searched.walk);
    const bool begun_better =
        request.initial &&
        (result.walk.empty() || problem.score_of(result.walk) < problem.score_of(*request.initial));
    if (begun_better) {
      result.walk = *request.initial;
      searched.message += "; the initial tour is better and is kept";
    }
    if (result.walk.empty()) {
      const bool claims = searched.status == TourStatus::feasible;
      if (claims) return broken("the solver returned no tour");
      return finish(searched.status, searched.message);
    }
    report.score = problem.score_of(result.walk);
    report.seconds_used = problem.seconds_of(result.walk);
    report.images = TourProblem::images_of(result.walk);
    if (report.score <= 0 && searched.status == TourStatus::feasible) {
      result.walk.clear();
      return finish(TourStatus::infeasible,
                    "no view with information fits into the budget: " + searched.message);
    }
    if (request.bound) report.upper_bound = tour_upper_bound(problem, result.walk);
    if (searched.upper_bound) {
      report.upper_bound = std::min(report.upper_bound, *searched.upper_bound);
    }
    const double missing = report.upper_bound - report.score;
    report.gap = std::isfinite(missing) ? std::max(0.0, missing / report.upper_bound) : 1;
    const bool proven = report.gap <= kProven && searched.status != TourStatus::cancelled;
    return finish(proven ? TourStatus::optimal : searched.status, searched.message);
  } catch (const std::exception& error) {
    result.walk.clear();
    return finish(TourStatus::failed, error.what());
  }
}

}  // namespace lapwing
