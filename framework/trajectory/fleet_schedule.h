// SPDX-License-Identifier: Apache-2.0
// When the tours of a fleet begin, so that its drones keep apart.
//
// The verifier does not use this: it measures distances along the motions that it integrates
// itself (verify/fleet.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/trajectory/trajectory.h"

namespace lapwing {

struct FleetRules {
  double separation = 0;  // m, least distance between two drones in flight; 0: none is kept
  double swap = 0;        // s, least time between two tours of one drone
};

struct TourToFly {
  std::string drone;
  const Trajectory* trajectory = nullptr;  // outlives the call
};

struct ScheduledTour {
  std::size_t tour = 0;  // its place among the tours that were given
  double start = 0;      // s after the fleet begins, a multiple of 0.5
  int battery = 1;       // of its drone, from 1
};

// In the order of their starts; the first one is at 0. Tours are taken one by one: always the tour
// of any drone that can begin soonest after its drone's last one, later where it would come closer
// than `separation` to one that is scheduled. Half a swap before and after its tour a drone may be
// anywhere on the vertical line below the tour's first and last place: it climbs and lands there.
// A tour that begins when all others have landed comes near none, so that there is always a
// schedule. Deterministic. Error where a tour has no samples.
std::vector<ScheduledTour> fleet_schedule(std::span<const TourToFly> tours,
                                          const FleetRules& rules);

}  // namespace lapwing
