// SPDX-License-Identifier: Apache-2.0
// A telemetry log as a flight log.
#pragma once

#include <string>
#include <string_view>

#include "framework/flight_log/flight_log.h"

namespace lapwing::tlog {

// InputError for bytes without a record, for more than 1 GiB, and for a log in which no vehicle
// tells where it is or how it is turned.
FlightLog read(std::string_view bytes);

// A second of HEARTBEAT and LOCAL_POSITION_NED.
std::string example();

}  // namespace lapwing::tlog
