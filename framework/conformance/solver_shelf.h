// SPDX-License-Identifier: Apache-2.0
// Small problems with known answers, on which trajectory solvers are checked. Internal to the room.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/progress.h"
#include "framework/problem/trajectory_problem.h"

namespace lapwing {

struct ShelfProblem {
  std::string name;
  TrajectoryProblem problem;
  std::optional<double> optimum;  // absent: there is no feasible point
  bool curved = false;            // a solver may say that it does not take such problems
  bool trap = false;  // so badly scaled that a solver may stop short, but must not say infeasible
};

std::vector<ShelfProblem> solver_shelf();

// Counts how often the problem asks a term of its own: the work of a solver as the kernel sees it,
// whatever the solver says of itself. May act in the middle of a solve.
struct SolverWatch {
  std::atomic<int> calls = 0;
  int cancel_after = 0;  // calls, then the token is cancelled; 0: never
  CancellationToken token;
  double pause = 0;  // s, slept in every call
};
// Takes any solver some tens of evaluations: the minimum of x^4, from far away. Curved.
TrajectoryProblem watched_problem(SolverWatch& watch);
// The same with x^2, for solvers of quadratic problems alone.
TrajectoryProblem watched_quadratic_problem(SolverWatch& watch);
// Quadratic programs of a few numbers, dense; not yet finished.
void add_small_programs(std::vector<ShelfProblem>& shelf);

}  // namespace lapwing
