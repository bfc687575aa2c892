// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/trajectory_solver.h"

#include <cmath>

namespace lapwing {

namespace {

// What is wrong with a solver's answer; empty when nothing is.
std::string mistake_in(const SolveResult& result, const TrajectoryProblem& problem) {
  const SolveReport& report = result.report;
  const Stages& stages = result.point.stages;
  const std::string claims = std::string("it reports '") + to_string(report.status) + "', but ";
  const bool claimed =
      report.status == SolveStatus::optimal || report.status == SolveStatus::feasible;
  const bool sized =
      stages.rows() == problem.layout().size() && stages.cols() == problem.horizon().stages;
  if (!sized && (claimed || stages.size() > 0)) return claims + "its point is not the problem's";
  for (Eigen::Index stage = 0; stage < stages.cols(); ++stage)
    for (int b = 0; b < problem.layout().count(); ++b) {
      const BlockSpec& block = problem.layout().block(b);
      if (!stages.col(stage).segment(problem.layout().offset(b), block.size).allFinite())
        return claims + "'" + block.name + "' of stage " + std::to_string(stage) +
               " is not a finite number";
    }
  if (!std::isfinite(report.cost)) return claims + "its cost is not a finite number";
  for (const TermCost& term : report.terms)
    if (!std::isfinite(term.cost)) return claims + "the cost of '" + term.name + "' is not finite";
  for (const Violation& violation : report.violations)
    if (!std::isfinite(violation.amount) || !std::isfinite(violation.time))
      return claims + "the violation of '" + violation.name + "' is not finite";
  for (const SolveIteration& it : report.history) {
    bool finite = std::isfinite(it.cost) && std::isfinite(it.violation) && std::isfinite(it.step);
    for (const double cost : it.terms) finite &= std::isfinite(cost);
    if (!finite || it.terms.size() > report.terms.size())
      return claims + "iteration " + std::to_string(it.iteration) + " of its history " +
             (finite ? "has more terms than the report" : "is not finite");
  }
  return "";
}

}  // namespace

const char* to_string(SolveStatus status) {
  switch (status) {
    case SolveStatus::optimal:
      return "optimal";
    case SolveStatus::feasible:
      return "feasible";
    case SolveStatus::infeasible:
      return "infeasible";
    case SolveStatus::iteration_limit:
      return "iteration_limit";
    case SolveStatus::time_limit:
      return "time_limit";
    case SolveStatus::cancelled:
      return "cancelled";
    case SolveStatus::unsupported:
      return "unsupported";
    case SolveStatus::numerical_error:
      return "numerical_error";
  }
  return "numerical_error";
}

Value to_value(const SolveReport& report, const std::string& solver_name) {
  Value result = Value::map();
  result.set("name", solver_name);
  result.set("status", to_string(report.status));
  if (!report.message.empty()) result.set("message", report.message);
  result.set("iterations", report.iterations);
  result.set("cost", report.cost);
  Value terms = Value::map();
  for (const TermCost& term : report.terms) terms.set(term.name, term.cost);
  result.set("terms", std::move(terms));
  Value violations = Value::list();
  for (const Violation& v : report.violations) {
    Value entry = Value::map();
    entry.set("name", v.name);
    entry.set("row", v.row);
    entry.set("amount", v.amount);
    entry.set("time", v.time);
    violations.push_back(std::move(entry));
  }
  result.set("violations", std::move(violations));
  Value history = Value::list();
  for (const SolveIteration& it : report.history) {
    Value entry = Value::map();
    entry.set("iteration", it.iteration);
    entry.set("cost", it.cost);
    entry.set("violation", it.violation);
    entry.set("step", it.step);
    Value costs = Value::map();
    for (std::size_t k = 0; k < it.terms.size(); ++k) costs.set(report.terms[k].name, it.terms[k]);
    entry.set("terms", std::move(costs));
    history.push_back(std::move(entry));
  }
  result.set("history", std::move(history));
  return result;
}

SolveResult solve_by(const TrajectorySolver& solver, const TrajectoryProblem& problem,
                     const SolveRequest& request) {
  SolveResult result = in_plugin(
      solver, "solve", [&] { return solver.solve(problem, request); }, CallLength::lengthy);
  const std::string mistake = mistake_in(result, problem);
  if (!mistake.empty())
    throw plugin_failure(solver.plugin_name() ? solver.plugin_name() : "solver", "solve", mistake);
  return result;
}

}  // namespace lapwing
