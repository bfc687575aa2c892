// SPDX-License-Identifier: Apache-2.0
// A ULog file of PX4 as a flight log.
#pragma once

#include <string>
#include <string_view>

#include "framework/flight_log/flight_log.h"

namespace lapwing::ulog {

// InputError for bytes that are no ULog, and for one without a sample of a known topic.
FlightLog read(std::string_view bytes);

// A small ULog with a second of vehicle_local_position.
std::string example();

}  // namespace lapwing::ulog
