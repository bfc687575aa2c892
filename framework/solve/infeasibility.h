// SPDX-License-Identifier: Apache-2.0
// Proofs that a quadratic program has no solution. Internal to the room.
#pragma once

#include "framework/solve/quadratic_program.h"

namespace lapwing {

// Farkas: row multipliers y and the bounds that A'y pushes to, whose support is positive, so that
// no point meets rows and bounds. What no bound takes up is weighed against the size of the point.
bool is_infeasibility_certificate(const QuadraticProgram& problem, const QuadraticResult& at);

// P x = 0, c'x < 0, and x points along no row or bound: the cost falls for ever along x.
bool is_unbounded_ray(const QuadraticProgram& problem, const Eigen::VectorXd& x);

}  // namespace lapwing
