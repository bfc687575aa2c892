// SPDX-License-Identifier: Apache-2.0
// What every trajectory solver must pass.
#include <cmath>

#include "framework/conformance/differences.h"
#include "framework/conformance/every_case.h"
#include "framework/conformance/solver_shelf.h"
#include "framework/conformance/solver_stops.h"

namespace lapwing {
namespace {

constexpr double kCost = 1e-5;       // of the optimum, at least of 1
constexpr double kViolation = 1e-5;  // of a point that is called feasible

double worst_violation(const TrajectoryProblem& problem, const Stages& at) {
  const std::vector<Violation> violations = problem.violations(at);
  return violations.empty() ? 0.0 : violations.front().amount;
}

class SolverCheck {
 public:
  SolverCheck(const TrajectorySolver& solver, const CheckOptions& options, Findings& findings)
      : solver_(solver), options_(options), findings_(findings) {}

  // Whether answers must be right: with a parameter at the end of its range (one iteration, the
  // loosest tolerance) they need not be, but must stay honest.
  void run(bool right) {
    if (!right && !options_.wants_any({"point", "reported cost", "reported violations", "status"}))
      return;
    if (right && options_.wants_any({"work limit", "cancellation", "wall clock"}))
      check_solver_stops(solver_, findings_);
    if (findings_.settled()) return;
    for (const ShelfProblem& item : solver_shelf()) {
      const SolveResult result = solver_.solve(item.problem, {});
      if (item.curved && result.report.status == SolveStatus::unsupported) continue;
      honest(item, result);
      if (!right) continue;
      answer(item, result);
      if (item.optimum && !item.trap && options_.wants("warm start")) warm_start(item, result);
      if (options_.wants("repeatable")) repeatable(item, result);
      if (options_.wants_any({"work limit", "cancellation"})) limits(item);
    }
  }

 private:
  static bool is_whole(const ShelfProblem& item, const SolveResult& result) {
    const Stages& at = result.point.stages;
    return at.rows() == item.problem.layout().size() &&
           at.cols() == item.problem.horizon().stages && at.allFinite();
  }

  void honest(const ShelfProblem& item, const SolveResult& result) {
    const Stages& at = result.point.stages;
    const SolveReport& report = result.report;
    const bool whole = is_whole(item, result);
    findings_.expect("point", whole, [&] {
      return item.name + ": returns no whole, finite point with status " + to_string(report.status);
    });
    if (!whole) return;
    const double cost = item.problem.cost(at), worst = worst_violation(item.problem, at);
    findings_.expect("reported cost", std::abs(report.cost - cost) <= 1e-9 * (1 + std::abs(cost)),
                     [&] {
                       return item.name + ": reports " + text_of(report.cost) +
                              ", its point costs " + text_of(cost);
                     });
    const double told = report.violations.empty() ? 0.0 : report.violations.front().amount;
    findings_.expect("reported violations", std::abs(told - worst) <= 1e-9 * (1 + worst), [&] {
      return item.name + ": reports at most " + text_of(told) + ", its point violates by " +
             text_of(worst);
    });
    const bool claims =
        report.status == SolveStatus::optimal || report.status == SolveStatus::feasible;
    findings_.expect("status", !claims || worst <= kViolation, [&] {
      return item.name + ": says " + to_string(report.status) + ", violates by " + text_of(worst);
    });
    findings_.expect("status", item.optimum || !claims, [&] {
      return item.name + ": says " + to_string(report.status) + ", but no point is feasible";
    });
  }

  void answer(const ShelfProblem& item, const SolveResult& result) {
    const SolveReport& report = result.report;
    if (!item.optimum) {
      findings_.expect("infeasible", report.status == SolveStatus::infeasible, [&] {
        return item.name + ": says " + to_string(report.status) + ": " + report.message;
      });
      const bool named = !report.message.empty() && !report.violations.empty() &&
                         report.violations.front().amount > kViolation &&
                         !report.violations.front().row.empty();
      findings_.expect("infeasible", named,
                       [&] { return item.name + ": does not say what cannot be met, and when"; });
      return;
    }
    findings_.expect("infeasible", report.status != SolveStatus::infeasible, [&] {
      return item.name + ": says infeasible of a problem that is not: " + report.message;
    });
    // Of a badly scaled problem a solver may own that it did not come to the end.
    if (item.trap && report.status != SolveStatus::optimal) return;
    findings_.expect("optimum", report.status == SolveStatus::optimal, [&] {
      return item.name + ": says " + to_string(report.status) + ": " + report.message;
    });
    if (!is_whole(item, result)) return;
    const double cost = item.problem.cost(result.point.stages);
    const double scale = std::max(1.0, std::abs(*item.optimum));
    findings_.expect("optimum", std::abs(cost - *item.optimum) <= kCost * scale, [&] {
      return item.name + ": finds " + text_of(cost) + ", the optimum is " + text_of(*item.optimum);
    });
  }

  void warm_start(const ShelfProblem& item, const SolveResult& cold) {
    SolveRequest request;
    request.warm_start = cold.point;
    const SolveResult warm = solver_.solve(item.problem, request);
    findings_.expect("warm start",
                     warm.report.status == cold.report.status &&
                         warm.report.iterations <= cold.report.iterations,
                     [&] {
                       return item.name + ": from its own optimum " +
                              std::to_string(warm.report.iterations) + " iterations (" +
                              to_string(warm.report.status) + "), cold " +
                              std::to_string(cold.report.iterations);
                     });
    const double scale = kCost * std::max(1.0, std::abs(cold.report.cost));
    findings_.expect("warm start", warm.report.cost <= cold.report.cost + scale,
                     [&] { return item.name + ": ends worse than where it began"; });
  }

  void repeatable(const ShelfProblem& item, const SolveResult& first) {
    const SolveResult second = solver_.solve(item.problem, {});
    findings_.expect("repeatable",
                     first.report.status == second.report.status &&
                         first.report.iterations == second.report.iterations &&
                         first.point.stages == second.point.stages,
                     [&] { return item.name + ": two runs end differently"; });
  }

  void limits(const ShelfProblem& item) {
    SolveRequest request;
    request.iteration_limit = 1;
    const SolveResult limited = solver_.solve(item.problem, request);
    findings_.expect("work limit", limited.report.iterations <= 1, [&] {
      return item.name + ": " + std::to_string(limited.report.iterations) +
             " iterations where one was allowed";
    });
    honest(item, limited);
    CancellationToken token;
    token.cancel();
    request = {};
    request.cancellation = &token;
    const SolveResult cancelled = solver_.solve(item.problem, request);
    findings_.expect("cancellation", cancelled.report.status == SolveStatus::cancelled, [&] {
      return item.name + ": cancelled before it began, says " + to_string(cancelled.report.status);
    });
    honest(item, cancelled);
  }

  const TrajectorySolver& solver_;
  const CheckOptions& options_;
  Findings& findings_;
};

}  // namespace

std::vector<CheckResult> check_trajectory_solver(const Specimen<TrajectorySolver>& subject,
                                                 const CheckOptions& options) {
  return check_every_case(subject, options, "a solve",
                          [&](const TrajectorySolver& solver, Findings& findings, bool first) {
                            SolverCheck(solver, options, findings).run(first);
                          });
}

}  // namespace lapwing
