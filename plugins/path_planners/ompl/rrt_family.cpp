// SPDX-License-Identifier: Apache-2.0
// The three planners that grow trees and may rewire them.
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>

#include "plugins/path_planners/ompl/search.h"

namespace lapwing {

namespace og = ompl::geometric;

PlannerPointer make_rrt(const SpacePointer& space, const OmplSettings& settings) {
  auto planner = std::make_shared<og::RRT>(space);
  planner->setGoalBias(settings.goal_bias);
  if (settings.range > 0) planner->setRange(settings.range);
  return planner;
}

PlannerPointer make_rrt_star(const SpacePointer& space, const OmplSettings& settings) {
  auto planner = std::make_shared<og::RRTstar>(space);
  planner->setGoalBias(settings.goal_bias);
  planner->setRewireFactor(settings.rewire_factor);
  if (settings.range > 0) planner->setRange(settings.range);
  return planner;
}

PlannerPointer make_rrt_connect(const SpacePointer& space, const OmplSettings& settings) {
  auto planner = std::make_shared<og::RRTConnect>(space);
  if (settings.range > 0) planner->setRange(settings.range);
  return planner;
}

}  // namespace lapwing
