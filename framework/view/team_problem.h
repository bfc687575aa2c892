// SPDX-License-Identifier: Apache-2.0
// The team orienteering problem (Chao, Golden and Wasil, "The team orienteering problem", EJOR
// 1996): several tours over the same views, each with its own start, end, budget and image limit,
// that share one score.
//
// A view counts once, whichever tour takes it, and a voxel saturates once over all tours
// (view_score.h). Each tour is a tour problem of its own, so that tours may have different motions:
// of a slower vehicle, or from another home. Every tour is flown; one that has nothing to see is
// the way from its start to its end.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/view/tour_problem.h"

namespace lapwing {

struct TeamTour {
  std::string name;  // unique: of the drone and its battery
  TourProblem problem;
};

using Walks = std::vector<std::vector<int>>;  // one per tour, in the team's order

// Immutable but for ways (tour_problem.h); thread-safe.
class TeamProblem {
 public:
  // InputError where there is no tour, two have one name, their scores are different objects, or
  // some have legs and others motions.
  explicit TeamProblem(std::vector<TeamTour> tours);

  int size() const { return static_cast<int>(tours_.size()); }
  const TourProblem& tour(int index) const { return tours_[index].problem; }
  const std::string& name(int index) const { return tours_[index].name; }
  int views() const { return tour(0).views(); }
  const ViewScore& score() const { return tour(0).score(); }

  // Of all views on the walks together.
  double score_of(const Walks& walks) const;
  // What is wrong with the walks, "" when each is a tour of its problem; names the tour.
  std::string problem_of(const Walks& walks) const;
  // Views that some tour can reach within its budget, ascending.
  std::vector<int> reachable() const;
  // Why some tour cannot be flown at all; "" where all can. Names the tour.
  std::string why_infeasible() const;

 private:
  std::vector<TeamTour> tours_;
};

// `count` tours of one definition, named "1", "2", ...; they share their ways. InputError for a
// count below 1, and as TourProblem has it.
TeamProblem equal_tours(TourDefinition definition, int count);

}  // namespace lapwing
