// SPDX-License-Identifier: Apache-2.0
// First penalties of an augmented cost.
#pragma once

#include "plugins/trajectory_solvers/nlopt/scaling.h"

namespace lapwing {

// Penalties follow the cost's own curvature along each limit's normal a, so that neither units nor
// weights matter: for equations that of meeting one while all others hold, (A H^-1 A')^-1 on its
// diagonal; for other limits 1 / (a' H^-1 a), the equations held by their penalties. Measured at
// `model`, for other limits at some of every name. Changes `scaling`.
void set_first_penalties(const ReducedProblem& reduced, const LocalModel& model,
                         AugmentedCost& cost, Scaling& scaling);

}  // namespace lapwing
