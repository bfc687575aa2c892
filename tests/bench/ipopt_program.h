// SPDX-License-Identifier: Apache-2.0
// Ipopt on a quadratic program, for benchmarks: same matrices, told that they are constant.
#pragma once

#include "framework/solve/quadratic_program.h"

namespace lapwing {

// One thread, MUMPS, `tolerance` as Ipopt's own. `mehrotra`: its option for convex quadratic
// programs. Throws Error when Ipopt does not report success.
QuadraticResult solve_with_ipopt(const QuadraticProgram& problem, double tolerance, bool mehrotra);

}  // namespace lapwing
