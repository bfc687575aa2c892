// SPDX-License-Identifier: Apache-2.0
// What is flown of a plan: a trajectory with places, velocities, accelerations and headings.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

struct LiveFlight {
  Plan plan;  // with the trajectory that is flown
  Vehicle vehicle;
  std::vector<std::string> said;  // for the user
  std::filesystem::path folder;   // of the plan's meshes and maps

  const Trajectory& trajectory() const { return plan.trajectory; }
};

// The plan itself. A path without velocities, as an exploration is stored, is flown with a stop in
// every place (vehicle/path_flight.h), and that flight is certified anew for safety; meshes and
// maps are read from `folder`. Throws InputError for a vehicle that does not hover, for a plan
// without length, for numbers that are not finite, and for a flight along a path that would break a
// limit or come too near to an obstacle.
LiveFlight live_flight_of(const Plan& plan, const std::filesystem::path& folder);

}  // namespace lapwing
