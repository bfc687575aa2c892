// SPDX-License-Identifier: Apache-2.0
// A trajectory solver: from a problem and an initial guess to the best trajectory it finds.
//
// A solver reports, it never throws or aborts for what happens inside a solve. It honours its work
// limit and cancellation, returns its best iterate so far, and takes a warm start. Work limits
// count iterations, so that results repeat; the wall-clock guard is a guard, and a run that it ends
// is not reproducible.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/plugin_object.h"
#include "framework/core/progress.h"
#include "framework/problem/trajectory_problem.h"

namespace lapwing {

enum class SolveStatus {
  optimal,     // feasible, and no better point nearby, to the solver's tolerances
  feasible,    // feasible, stopped before it was shown to be optimal
  infeasible,  // no feasible point nearby; the report names what cannot be met
  iteration_limit,
  time_limit,
  cancelled,
  unsupported,  // the solver does not take problems of this kind
  numerical_error,
};
const char* to_string(SolveStatus status);

struct SolveIteration {
  int iteration = 0;
  double cost = 0;
  double violation = 0;       // worst row violation
  double step = 0;            // accepted step length in (0, 1]
  std::vector<double> terms;  // weighted cost per term, in the order of SolveReport::terms
};

struct SolveReport {
  SolveStatus status = SolveStatus::numerical_error;
  std::string message;  // why, in one sentence
  int iterations = 0;
  double cost = 0;
  std::vector<TermCost> terms;
  std::vector<Violation> violations;  // worst of each constraint, largest first
  std::vector<SolveIteration> history;
  double seconds = 0;  // wall clock; never written into plan.json
};

// As data for plan.json: no wall-clock figure in it.
Value to_value(const SolveReport& report, const std::string& solver_name);

// Where to begin: a point, and the row multipliers of an earlier solve where there are any.
struct WarmStart {
  Stages stages;
  Eigen::VectorXd row_multipliers;    // empty, or one per row
  Eigen::VectorXd bound_multipliers;  // empty, or one per column
};

// What a solver keeps from one solve to the next, where problems are alike: orderings, factors,
// scratch memory. It never changes an answer beyond the solver's tolerance.
class SolverMemory {
 public:
  virtual ~SolverMemory() = default;
};

struct SolveRequest {
  std::optional<WarmStart> warm_start;     // absent: the problem's initial guess
  std::optional<int> iteration_limit;      // absent: the solver's own parameter
  std::optional<double> wall_clock_guard;  // s
  // The caller's place for the solver's memory, null or empty at first; one solve at a time. What
  // another solver left there is replaced.
  std::unique_ptr<SolverMemory>* memory = nullptr;
  // Sees every point that the solver moves to, on the solving thread: for whoever draws meanwhile.
  std::function<void(const Stages& at)> moved = {};
  const CancellationToken* cancellation = nullptr;
  Progress* progress = nullptr;
};

struct SolveResult {
  SolveReport report;
  WarmStart point;  // the best iterate, to be read or to start from
};

class TrajectorySolver : public PluginObject {
 public:
  using Interface = TrajectorySolver;
  static constexpr const char* kKind = "trajectory_solver";
  virtual ~TrajectorySolver() = default;

  virtual SolveResult solve(const TrajectoryProblem& problem,
                            const SolveRequest& request) const = 0;
};

// What `solver` answers: how it is called everywhere. PluginError, with its name, where it throws
// or answers with numbers that are not finite or a point of another size.
SolveResult solve_by(const TrajectorySolver& solver, const TrajectoryProblem& problem,
                     const SolveRequest& request);

}  // namespace lapwing
