// SPDX-License-Identifier: Apache-2.0
// MCAP recordings of JSON messages as flight logs.
#pragma once

#include <string>
#include <string_view>

#include "framework/flight_log/flight_log.h"

namespace lapwing::mcap_log {

// `vehicle` and `camera`: the frames of both in transforms; "": the usual names. InputError for
// bytes that are no MCAP, and where no channel gives a sample; it names those that there are.
FlightLog read(std::string_view bytes, const std::string& vehicle = "",
               const std::string& camera = "");

// A small recording with a second of foxglove.PoseInFrame.
std::string example();

}  // namespace lapwing::mcap_log
