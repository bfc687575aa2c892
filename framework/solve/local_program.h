// SPDX-License-Identifier: Apache-2.0
// The quadratic program of a local model: what one step of sequential quadratic programming solves.
#pragma once

#include "framework/problem/trajectory_problem.h"
#include "framework/solve/quadratic_program.h"

namespace lapwing {

// Its variables are the step; TrajectoryProblem::retract takes it.
QuadraticProgram local_program(const LocalModel& model);

}  // namespace lapwing
