// Small problems with known answers, on which trajectory solvers are checked. Internal to the room.
#pragma once

#include <optional>
#include <string>
#include <vector>

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
// Quadratic programs of a few numbers, dense; not yet finished.
void add_small_programs(std::vector<ShelfProblem>& shelf);

}  // namespace lapwing
