// SPDX-License-Identifier: Apache-2.0
// Small tour problems whose answers are known by enumeration. Internal to the room and to tests.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/view/team_problem.h"

namespace lapwing {

// The best score of any tour, by trying every set of views with the quickest walk through it; at
// most 16 views. Shares no code with bounds, solvers and shortest ways: it reads `definition`.
// Negative where there is no tour.
double best_score_by_enumeration(const TourDefinition& definition);

// Likewise of a team, whose tours share a score: the best of all unions of sets that tours can see;
// at most 13 views.
double best_team_score_by_enumeration(const std::vector<TourDefinition>& tours);

// What is wrong with a walk, "" when nothing is; likewise of `definition` alone: a motion for every
// pair, ends, the budget, the number of images, nothing visited twice where legs are stated.
std::string fault_of_walk(const TourDefinition& definition, const std::vector<int>& walk);
// Of the views of a walk together.
double score_of_walk(const TourDefinition& definition, const std::vector<int>& walk);
double score_of_walks(const TourDefinition& definition, const std::vector<std::vector<int>>& walks);

struct TourWorldOptions {
  int views = 10;
  int voxels = 40;
  bool legs = false;  // legs between all views instead of motions between near ones
  bool loop = true;
  bool additive = false;      // a score per view
  double budget_share = 0.5;  // of what all views take, roughly
  int image_limit = 0;        // 0 for none
};
// Views strewn over a square, each seeing the voxels near it.
TourDefinition random_tour(std::uint64_t seed, const TourWorldOptions& options);

struct TourWorld {
  std::string name;
  TourDefinition definition;
  double best = -1;  // negative: infeasible
};
// Loops and ways, motions and legs, coverage and scores, with and without a limit of images, and
// some that cannot be.
std::vector<TourWorld> tour_worlds();

struct TeamWorld {
  std::string name;
  std::vector<TourDefinition> tours;
  double best = -1;  // negative: infeasible
};
TeamProblem team_of(const TeamWorld& world);
// Tours with the same and with different ends, budgets, motions and limits of images.
std::vector<TeamWorld> team_worlds();

}  // namespace lapwing
