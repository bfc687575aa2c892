// SPDX-License-Identifier: Apache-2.0
// What scans with several batteries hold: tours that share one score, and the plans made of them.
#pragma once

#include <string>
#include <vector>

#include "framework/mission/run.h"
#include "framework/mission/scan_objects.h"
#include "framework/trajectory/fleet.h"

namespace lapwing {

// Tours of one graph, in the order in which they were asked for.
struct TeamObject {
  std::string solver;
  TeamReport report;
  std::vector<TourObject> tours;
  std::vector<int> reachable = {};  // views that some tour can reach within its budget, ascending
};

// Plans and who flies them; `document` has no checksums and no certificate yet. One plan for each
// of its tours, in its order.
struct FleetObject {
  Fleet document;
  std::vector<PlanObject> plans;
  SolveReport report;
  std::string solver;
  std::vector<std::string> notes;               // sentences for the user
  std::vector<std::string> told;                // likewise, that stand in no plan
  Value block;                                  // figures, for --json
  std::shared_ptr<const ScanRecord> scan = {};  // of all tours together
  std::function<std::vector<Section>(const Plan&)> late_sections;  // as of MissionResult
};

inline constexpr const char* kTeamType = "team";
inline constexpr const char* kFleetType = "fleet";

void open_fleet_library(lua_State* state);
// solve_team, team_solvers, accurate_area, fleet.
std::span<const Binding> fleet_methods_of_run();

// The parts of that list.
std::span<const Binding> team_methods_of_run();
std::span<const Binding> accuracy_methods_of_run();
void open_team_type(lua_State* state);

}  // namespace lapwing
