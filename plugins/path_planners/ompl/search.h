// SPDX-License-Identifier: Apache-2.0
// A search by one of OMPL's planners, behind a border without OMPL's headers.
#pragma once

#include <memory>

#include "framework/path/path_planner.h"

namespace ompl::base {
class Planner;
class SpaceInformation;
}  // namespace ompl::base

namespace lapwing {

struct OmplSettings {
  std::int64_t iterations = 10000;
  double range = 0;         // m, longest piece added at once; 0: a share of the bounds
  double goal_bias = 0.05;  // share of samples that are the goal
  double rewire_factor = 1.1;
  int samples_per_batch = 100;
};

using PlannerPointer = std::shared_ptr<ompl::base::Planner>;
using SpacePointer = std::shared_ptr<ompl::base::SpaceInformation>;
using MakePlanner = PlannerPointer (*)(const SpacePointer&, const OmplSettings&);

PlannerPointer make_rrt(const SpacePointer& space, const OmplSettings& settings);
PlannerPointer make_rrt_star(const SpacePointer& space, const OmplSettings& settings);
PlannerPointer make_rrt_connect(const SpacePointer& space, const OmplSettings& settings);
PlannerPointer make_informed_rrt_star(const SpacePointer& space, const OmplSettings& settings);
PlannerPointer make_bit_star(const SpacePointer& space, const OmplSettings& settings);

struct OmplOutcome {
  PathStatus status = PathStatus::iteration_limit;
  std::string message;
  std::int64_t iterations = 0;
  std::vector<Eigen::Vector3d> points;
};

// Searches take turns: OMPL's random numbers come from one generator of the process, which each
// search seeds anew.
OmplOutcome search_with_ompl(const PathProblem& problem, const PathRequest& request,
                             const OmplSettings& settings, MakePlanner make);

}  // namespace lapwing
