// Small problems with known answers, on which trajectory solvers are checked. Internal to the room.
#pragma once

#include <optional>

#include "framework/problem/trajectory_problem.h"

namespace lapwing {

struct ShelfProblem {
  std::string name;
  TrajectoryProblem problem;
  std::optional<double> optimum;  // absent: there is no feasible point
  bool curved = false;            // a solver may say that it does not take such problems
};

std::vector<ShelfProblem> solver_shelf();

}  // namespace lapwing
