// SPDX-License-Identifier: Apache-2.0
// Whether a trajectory solver stops when it is told to. Internal to the room.
#pragma once

#include "framework/conformance/findings.h"

namespace lapwing {

// In the middle of a solve: cancelled by a term that is asked, or by who is told of the progress;
// out of time; out of work. The work is what the problem's own term was asked, not what the solver
// reports. Checks "work limit", "cancellation" and "wall clock".
void check_solver_stops(const TrajectorySolver& solver, Findings& findings);

}  // namespace lapwing
