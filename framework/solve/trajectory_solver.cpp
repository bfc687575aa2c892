#include "framework/solve/trajectory_solver.h"

namespace lapwing {

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

}  // namespace lapwing
