// SPDX-License-Identifier: Apache-2.0
// Times of a log in words.
#pragma once

#include <string>

#include "framework/flight_log/flight_log.h"

namespace lapwing {

// "2024-03-09 16:00:00.25 UTC" of seconds since 1970, rounded to `decimals` (0 to 6). Empty for
// what is no year from 1970 to 9999.
std::string utc_text(double seconds, int decimals = 2);

// A time of the log's clock: "12.25 s of the log", with its UTC where the log tells it: "12.25 s of
// the log (2024-03-09 16:00:00.25 UTC)"; of a clock that counts from 1970 the latter alone.
std::string moment_in_words(const FlightLog& log, double time, int decimals = 2);

}  // namespace lapwing
