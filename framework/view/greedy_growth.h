// SPDX-License-Identifier: Apache-2.0
// Growing a tour view by view, each time the one that promises most (thesis 4.4.3, 2.4).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "framework/view/tour_solver.h"
#include "framework/view/working_tour.h"

namespace lapwing {

struct GreedyGrowth {
  bool by_ratio = false;  // gain per second that the view adds, instead of gain
  // By submodularity a gain only shrinks while the tour grows: only views whose last known gain
  // could still win are evaluated again (thesis 2.4). Without it all are, in every round.
  bool lazy = true;
  std::span<const double> favour = {};  // per view, a factor on what it promises; empty for none
  // Most evaluations for one choice, after which the best so far is taken; 0 for no limit. For
  // `known` gains that are estimates.
  int patience = 0;
};

// What every view would bring alone: more than it can bring to any tour.
std::vector<double> gains_alone(const TourProblem& problem);

// Grows until nothing fits that brings anything, or the work ends. `known`: per view a gain that it
// cannot exceed now; updated.
void grow(WorkingTour& tour, std::vector<double>& known, const GreedyGrowth& growth, TourWork& work,
          std::int64_t iterations = 0);
// Likewise of several tours of one team: a view goes to the tour that it lengthens least.
void grow(std::span<WorkingTour* const> tours, std::vector<double>& known,
          const GreedyGrowth& growth, TourWork& work, std::int64_t iterations = 0);

}  // namespace lapwing
