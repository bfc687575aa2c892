// SPDX-License-Identifier: Apache-2.0
// What must hold before anything of a plan is sent.
#pragma once

#include <string>
#include <vector>

#include "framework/fly/live_flight.h"
#include "framework/fly/vehicle_report.h"

namespace lapwing {

// What does not hold yet, a sentence each, with what would be right: an autopilot that is known, a
// multirotor, its place within `start_tolerance` (m) of the plan's start, its clock, its home, a
// usable estimate, a battery for the flight and a fifth. Place and heading must be younger than
// 0.5 s at `now` (s, our clock), the report of the estimate younger than 3 s.
std::vector<std::string> missing_before_flight(const VehicleReport& report,
                                               const FlightFrame& frame, const LiveFlight& flight,
                                               const VehicleClock& clock, double start_tolerance,
                                               double now);

// "38.2 m from the plan's start: 12 m east, 36 m north, 0.3 m up of it".
std::string place_in_words(const Eigen::Vector3d& from_start);

}  // namespace lapwing
