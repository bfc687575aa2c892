// SPDX-License-Identifier: Apache-2.0
// A plan flown many times under drawn conditions.
#pragma once

#include <vector>

#include "framework/vehicle/closed_loop.h"

namespace lapwing {

// The conditions of the run with this seed: errors of mass and inertia drawn evenly from minus to
// plus what `spread` states, gusts and noise of the seed, and everything else as it is.
FlightConditions drawn_conditions(const FlightConditions& spread, std::uint64_t seed);

struct SeededRun {
  FlightConditions conditions;  // with its seed
  FlownPath path;
};

// `runs` flights with the seeds spread.seed, spread.seed + 1, ..., on at most `threads` threads (0:
// as many as there are). The same for any number of threads; the one of a seed is the same in any
// series. Throws as ControlledPlan::fly does.
std::vector<SeededRun> fly_runs(const ControlledPlan& plan, const FlightConditions& spread,
                                int runs, int threads,
                                const CancellationToken* cancellation = nullptr);

// The value below which this share of them lies, linear between neighbours; `share` within [0, 1].
// Of no values: not a number.
double quantile_of(std::vector<double> values, double share);

}  // namespace lapwing
