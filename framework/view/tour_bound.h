// SPDX-License-Identifier: Apache-2.0
// What no tour can exceed (submodularity; thesis 2.4).
//
// For any set S of views: best <= f(S) + what the gains f(v|S) of further views bring at most
// within the budget, as a fractional knapsack: a view on a tour has two legs, half of each is its
// own. With a limit of images also: best <= f(S) + the largest gains, as many as images are
// allowed.
#pragma once

#include <span>

#include "framework/view/team_problem.h"

namespace lapwing {

// The bound for one set S of views.
double tour_bound_with(const TourProblem& problem, std::span<const int> views);

// The least of several: with S empty, with all reachable views, and with parts of `walk` in the
// order of their gains. At least the score of any tour of the problem.
double tour_upper_bound(const TourProblem& problem, std::span<const int> walk);

// The same of a team: one knapsack as large as all tours together, in which a view takes what it
// takes on the tour where that is least.
double team_bound_with(const TeamProblem& problem, std::span<const int> views);
double team_upper_bound(const TeamProblem& problem, const Walks& walks);

}  // namespace lapwing
