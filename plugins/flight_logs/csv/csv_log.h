// SPDX-License-Identifier: Apache-2.0
// Flight records as comma-separated values: Lapwing's own, and those of apps for consumer drones.
#pragma once

#include <string>
#include <string_view>

#include "framework/flight_log/flight_log.h"

namespace lapwing::csv_log {

// Whether the headings are those of a record that `read` knows.
bool recognizes(std::string_view bytes);

// `from_sea`: heights above the sea are read where the file has both; else those above the
// take-off. InputError for headings that it does not know, and for a record without a row.
FlightLog read(std::string_view bytes, bool from_sea = false);

}  // namespace lapwing::csv_log
