// SPDX-License-Identifier: Apache-2.0
// What a scan keeps beside walls: zones, and a pilot's line of sight.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "framework/geometry/pilot_place.h"
#include "framework/mission/binding.h"
#include "framework/path/free_space.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

class Map;

struct FlightRules {
  Environment zones;  // closed airspace, and airspace that must not be left; with the margin
  std::optional<PilotPlace> pilot;
  double accuracy = 0;  // m, of the position in flight; part of the margin

  bool empty() const { return zones.obstacles.empty() && !pilot; }
};

struct FlightRulesObject {
  std::shared_ptr<const FlightRules> rules;
};
inline constexpr const char* kFlightRulesType = "flight rules";

void open_flight_rules_type(lua_State* state);
std::span<const Binding> flight_rule_methods_of_run();  // flight_rules

// The rules under the key `rules` of the table; none where it is missing.
std::shared_ptr<const FlightRules> rules_argument(lua_State* state, int table);

// `space` where the rules allow it as well. `map`: what hides the vehicle from a pilot.
std::unique_ptr<FreeSpace> ruled(std::unique_ptr<FreeSpace> space, const FlightRules& rules,
                                 std::shared_ptr<const Map> map);

// Why the rules forbid a box at a place, in words: "it lies in zone 'school', or nearer than 0.9
// m"; "" where they do not. Sight is not judged, for want of a map.
std::string forbidden_by(const FlightRules& rules, const Eigen::Vector3d& p,
                         const Eigen::Vector3d& half);

}  // namespace lapwing
