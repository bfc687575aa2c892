// SPDX-License-Identifier: Apache-2.0
// How fast lines between waypoints are to be flown, and how far their corners may be cut.
#pragma once

#include <vector>

#include "framework/export/waypoints.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// Sets `radius` of each waypoint, so that a cut corner is at most 0.3 `across` (m) from the
// waypoint, but 5 cm at least, and `speed` of each line: such that the flight that an autopilot
// makes of them (waypoint_flight.h) is at each waypoint as near to the time of the plan as speeds
// between half and twice those of the plan, within the limits of the vehicle, allow.
// `curves`: corners are curves that begin and end on their lines, as drones of DJI fly them. No
// radius is then more than 0.49 of the shorter line beside it, in whole centimetres.
void time_waypoints(std::vector<PlannedWaypoint>& waypoints, const Vehicle& vehicle, double across,
                    bool curves = false);

// The flight that orders for these waypoints ask for, without the camera.
struct WaypointFlight;
WaypointFlight flight_along(const std::vector<PlannedWaypoint>& waypoints);

}  // namespace lapwing
