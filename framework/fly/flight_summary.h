// SPDX-License-Identifier: Apache-2.0
// What is kept of a live flight beside its log.
#pragma once

#include "framework/fly/flight_session.h"
#include "framework/mavlink/packet_parser.h"

namespace lapwing {

// m, from what was sent, within which the vehicle followed.
bool followed_within(const FlightSession& session, double tolerance);

// {"mission", "end", "reason", "flown", "plan_time", "tolerance", "position_error_worst", ...},
// SI; yaw in rad; times of the plan in s.
Value flight_summary(const FlightSession& session, const LiveFlight& flight, double tolerance,
                     const mavlink::ParserCounts& counts);

}  // namespace lapwing
