// SPDX-License-Identifier: Apache-2.0
// Algorithm 2 of the thesis: a tour that grows from its middle (4.4.3; lazy list of 4.7).
//
// Between two views and with a budget for the part between them it takes the reachable view with
// the largest gain, solves the part before it with a share of the budget (half, in the thesis),
// then the part after it with all that is left. Reading 4.4: both ends belong to V from the start,
// a view must bring a gain, only inner views come back, an empty part costs the way between its
// ends, and the views that this way passes count. The first part gets less than its share where the
// way on needs more than the rest, else the rest of the tour could no longer be flown.
#pragma once

#include "framework/view/tour_solver.h"

namespace lapwing {

struct RecursiveTour {
  std::vector<int> walk;  // as TourProblem::problem_of wants it
  double score = 0;
  std::int64_t evaluations = 0;  // of this tour alone
  std::int64_t parts = 0;
};

// `evaluations` so far count towards the work's limit. A tour also where the work ends early.
RecursiveTour grow_recursively(const TourProblem& problem, TourWork& work,
                               std::int64_t evaluations = 0, double share = 0.5);

}  // namespace lapwing
