// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/players.h"

namespace lapwing {

void add_player_numbers(ParameterTable& table) {
  table
      .number("weight", 0.5, "", "weight of the stick against the planned acceleration",
              between(0, 1))
      .number("strength", 4, "m/s^2", "acceleration of a full deflection", above(0))
      .number("reach", 3, "m", "displacement across the course that full stick causes", above(0))
      .number("speed", 1, "", "factor on the reference speed", between(0.1, 3))
      .number("handicap", 0, "s", "added to the score", between(-3600, 3600));
}

void read_player_numbers(const Parameters& given, Pilot& pilot) {
  pilot.weight = given.number("weight");
  pilot.strength = given.number("strength");
  pilot.reach = given.number("reach");
  pilot.speed = given.number("speed");
  pilot.handicap = given.number("handicap");
}

ParameterTable player_table() {
  ParameterTable table;
  table.required_text("log", "stick log: CSV, time,forward,left")
      .text("name", "", "name; absent: that of the log");
  add_player_numbers(table);
  return table;
}

std::vector<Pilot> pilots_of(const std::vector<Parameters>& given, const DataFiles& files) {
  std::vector<Pilot> pilots;
  for (const Parameters& player : given) {
    const std::string& log = player.text("log");
    const std::filesystem::path file = files.find(log, "pilots");
    Pilot pilot{.name = player.text("name"), .log = read_stick_log(file)};
    if (pilot.name.empty()) pilot.name = file.stem().string();
    read_player_numbers(player, pilot);
    pilots.push_back(std::move(pilot));
  }
  return pilots;
}

}  // namespace lapwing
