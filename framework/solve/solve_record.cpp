// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/solve_record.h"

#include <cstdio>

namespace lapwing {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string crossed(const std::string& name, double lower, double upper) {
  return name + " must be at least " + number(lower) + " and at most " + number(upper);
}

}  // namespace

SolveRecord::SolveRecord(const TrajectoryProblem& problem, const SolveRequest& request)
    : problem_(problem), request_(request), began_(std::chrono::steady_clock::now()) {}

Stages SolveRecord::start() const {
  if (request_.warm_start) {
    const Stages& stages = request_.warm_start->stages;
    if (stages.rows() == problem_.layout().size() && stages.cols() == problem_.horizon().stages &&
        stages.allFinite())
      return stages;
  }
  return problem_.initial_guess();
}

bool SolveRecord::warm_multipliers() const {
  return request_.warm_start && request_.warm_start->row_multipliers.size() == problem_.rows() &&
         request_.warm_start->bound_multipliers.size() == problem_.columns();
}

std::optional<SolveStatus> SolveRecord::stopped() const {
  if (request_.cancellation && request_.cancellation->cancelled()) return SolveStatus::cancelled;
  if (request_.wall_clock_guard && seconds() > *request_.wall_clock_guard)
    return SolveStatus::time_limit;
  return {};
}

double SolveRecord::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

void SolveRecord::add(const Stages& at, double step) {
  const std::vector<Violation> violations = problem_.violations(at);
  add(at, problem_.term_costs(at), violations.empty() ? 0.0 : violations.front().amount, step);
}

void SolveRecord::add(const Stages& at, const std::vector<TermCost>& terms, double violation,
                      double step) {
  SolveIteration entry;
  entry.iteration = static_cast<int>(history_.size());
  entry.step = step;
  entry.violation = violation;
  for (const TermCost& term : terms) {
    entry.cost += term.cost;
    entry.terms.push_back(term.cost);
  }
  history_.push_back(std::move(entry));
  if (request_.moved && history_.size() > 1) request_.moved(at);
}

SolveResult SolveRecord::finish(SolveStatus status, std::string message, int iterations,
                                WarmStart point) const {
  SolveReport report;
  report.status = status;
  report.message = std::move(message);
  report.iterations = iterations;
  report.terms = problem_.term_costs(point.stages);
  for (const TermCost& term : report.terms) report.cost += term.cost;
  report.violations = problem_.violations(point.stages);
  report.history = history_;
  report.seconds = seconds();
  return {std::move(report), std::move(point)};
}

double worst_row_violation(const LocalModel& model, const Eigen::VectorXd& values) {
  if (values.size() == 0) return 0.0;
  return (model.row_lower - values).cwiseMax(values - model.row_upper).cwiseMax(0.0).maxCoeff();
}

std::string say_missed(const std::vector<Violation>& violations) {
  if (violations.empty() || !(violations.front().amount > 0)) return "";
  return violations.front().row + " is violated by " + number(violations.front().amount);
}

std::string say_crossed(const TrajectoryProblem& problem, const LocalModel& model) {
  for (int c = 0; c < problem.columns(); ++c) {
    const auto [lower, upper] = problem.bounds(c);
    if (lower > upper) return crossed(problem.bound_name(c, true), lower, upper);
  }
  for (int r = 0; r < problem.rows(); ++r)
    if (model.row_lower(r) > model.row_upper(r))
      return crossed(problem.row_name(r), model.row_lower(r), model.row_upper(r));
  return "";
}

}  // namespace lapwing
