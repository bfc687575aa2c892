// SPDX-License-Identifier: Apache-2.0
// What a view counts once views are taken to be independent: a published simplification of the
// coverage problem (Roberts et al., "Submodular Trajectory Optimization for Aerial 3D Scanning",
// ICCV 2017; thesis 4.5.2).
#pragma once

#include <vector>

#include "framework/view/tour_solver.h"

namespace lapwing {

struct FixedRewards {
  std::vector<double> of_view;  // 0 for a view that is left out
  int places = 0;               // that have more than one view to choose from
  std::int64_t evaluations = 0;
};

// The budget is ignored, the orientation of each place is fixed first: views are taken by gain,
// again and again, of each place the best one alone, and each counts what it brought then. A sum
// of rewards never is more than the score of the same views. Views joined by a motion that takes
// no time stand at one place; in a problem of legs every view is a place of its own.
FixedRewards fix_rewards(const TourProblem& problem, TourWork& work);
// Likewise of a team: starts and ends of all tours are taken first, and views that any tour joins
// by a motion without time are one place.
FixedRewards fix_rewards(const TeamProblem& problem, TourWork& work);

}  // namespace lapwing
