// SPDX-License-Identifier: Apache-2.0
// The order of a walk: as short as exchanging legs and moving views make it.
#pragma once

#include <vector>

#include "framework/view/tour_problem.h"

namespace lapwing {

// The views of `walk` in a shorter order, second visits left out where that is shorter; ends stay.
// Legs are shortest ways, so that neighbours in the result need not be joined by a motion. Local
// search by 2-opt and or-opt (up to three views, either way round) to its end. Empty where the walk
// is as short as these make it. `settled`: a walk that was as short as that, or empty; where `walk`
// still is like it nothing is tried.
std::vector<int> shorter_order(const TourProblem& problem, const std::vector<int>& walk,
                               const std::vector<int>& settled = {});

}  // namespace lapwing
