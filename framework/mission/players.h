// SPDX-License-Identifier: Apache-2.0
// Who fly a race by hand, as a script says it.
#pragma once

#include <vector>

#include "framework/core/parameters.h"
#include "framework/mission/data_files.h"
#include "framework/vehicle/race_flight.h"

namespace lapwing {

ParameterTable player_table();
// What is a player's beside name and log: weight, strength, reach, speed, handicap.
void add_player_numbers(ParameterTable& table);
void read_player_numbers(const Parameters& given, Pilot& pilot);
// Reads their logs. InputError as read_stick_log, and for a log that cannot be found.
std::vector<Pilot> pilots_of(const std::vector<Parameters>& given, const DataFiles& files);

}  // namespace lapwing
