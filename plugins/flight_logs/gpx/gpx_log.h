// SPDX-License-Identifier: Apache-2.0
// Tracks of GPX files as flight logs.
#pragma once

#include <string_view>

#include "framework/flight_log/flight_log.h"

namespace lapwing::gpx_log {

// Whether the bytes are XML whose first element is <gpx>.
bool recognizes(std::string_view bytes);

// All track points with a height. Points without times are `rate` per second apart; 0: they are
// refused. InputError with the line for text that is no XML from its beginning on, for other
// elements, and for files without a track of two points.
FlightLog read(std::string_view bytes, double rate = 0);

}  // namespace lapwing::gpx_log
