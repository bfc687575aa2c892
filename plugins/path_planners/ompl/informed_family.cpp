// SPDX-License-Identifier: Apache-2.0
// The two planners that look only where a path could still become shorter.
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>

#include "plugins/path_planners/ompl/search.h"

namespace lapwing {

namespace og = ompl::geometric;

PlannerPointer make_informed_rrt_star(const SpacePointer& space, const OmplSettings& settings) {
  auto planner = std::make_shared<og::InformedRRTstar>(space);
  planner->setGoalBias(settings.goal_bias);
  planner->setRewireFactor(settings.rewire_factor);
  if (settings.range > 0) planner->setRange(settings.range);
  return planner;
}

PlannerPointer make_bit_star(const SpacePointer& space, const OmplSettings& settings) {
  auto planner = std::make_shared<og::BITstar>(space);
  planner->setRewireFactor(settings.rewire_factor);
  planner->setSamplesPerBatch(static_cast<unsigned>(settings.samples_per_batch));
  return planner;
}

}  // namespace lapwing
