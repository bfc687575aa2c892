// SPDX-License-Identifier: Apache-2.0
// What every trajectory solver keeps while it works: the clock, the reasons to stop, the history;
// and what it says of its point at the end.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "framework/solve/trajectory_solver.h"

namespace lapwing {

class SolveRecord {
 public:
  // Both are kept by reference. The clock starts here.
  SolveRecord(const TrajectoryProblem& problem, const SolveRequest& request);

  // Where to begin: the warm start's stages where they fit the problem, else its initial guess.
  Stages start() const;
  // Whether the warm start has multipliers for every row and column.
  bool warm_multipliers() const;
  // Cancelled, or past the wall-clock guard.
  std::optional<SolveStatus> stopped() const;
  double seconds() const;

  // One line of history. `step` is the accepted step length.
  void add(const Stages& at, double step);
  // The same of a point whose costs and largest violation are known.
  void add(const Stages& at, const std::vector<TermCost>& terms, double violation, double step);
  const SolveIteration& latest() const { return history_.back(); }
  // The report on `point`, with its costs and violations.
  SolveResult finish(SolveStatus status, std::string message, int iterations,
                     WarmStart point) const;

 private:
  const TrajectoryProblem& problem_;
  const SolveRequest& request_;
  std::chrono::steady_clock::time_point began_;
  std::vector<SolveIteration> history_;
};

// Largest violation of a row at its values, in the row's own unit.
double worst_row_violation(const LocalModel& model, const Eigen::VectorXd& values);

// "hard_keyframe.x at 5 s is violated by 2.3": the largest violation, "" when there is none.
std::string say_missed(const std::vector<Violation>& violations);

// The first bound or row whose lower limit exceeds its upper one, "" when there is none:
// "boundary_state: position.x at 0 s must be at least 3 and at most 2".
std::string say_crossed(const TrajectoryProblem& problem, const LocalModel& model);

}  // namespace lapwing
