// SPDX-License-Identifier: Apache-2.0
// Problems that the benchmarks solve.
#pragma once

#include "framework/plugin/registry.h"
#include "framework/problem/trajectory_problem.h"
#include "framework/solve/quadratic_program.h"

namespace lapwing {

// The pure quadratic problem of thesis 3.6: `seconds` of flight at 10 stages a second, 12 keyframes
// every 30 s drawn from `seed` in a box that the vehicle can just follow, snap cost, bounds on the
// inputs, at rest at both ends.
TrajectoryProblem quadratic_flight(const Registry& registry, double seconds, std::uint64_t seed);

// Its quadratic program around the initial guess.
QuadraticProgram program_of(const TrajectoryProblem& problem);

}  // namespace lapwing
