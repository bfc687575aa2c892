// SPDX-License-Identifier: Apache-2.0
// Large neighbourhood search over all tours of a team.
#pragma once

#include <vector>

#include "framework/view/tour_solver.h"

namespace lapwing {

struct AnnealingSettings {
  std::int64_t iterations;
  double share;      // of a tour's views, most taken out at once
  double warmth;     // of a typical view's share in the score, at the beginning
  double exchanges;  // share of the iterations that begin by putting in
  double chance;     // how much promises are scattered
  int patience;      // evaluations for one choice
};

struct AnnealedTeam {
  Walks walks;  // the best of all
  std::int64_t evaluations = 0, iterations = 0;
};

// From `initial`, or from greedy insertion by gain per second where that is null.
AnnealedTeam anneal_team(const TeamProblem& problem, const AnnealingSettings& settings,
                         TourWork& work, const Walks* initial);

}  // namespace lapwing
