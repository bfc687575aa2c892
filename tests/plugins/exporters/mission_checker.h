// SPDX-License-Identifier: Apache-2.0
// The rules by which QGroundControl, MAVSDK and pymavlink load missions, as a checker of files. It
// shares nothing with the exporters. Rules and where they come from:
//   .plan: PlanMasterController, MissionItem, SimpleMissionItem and JsonParsing of QGroundControl,
//     mission_import of MAVSDK
//   .waypoints: MissionItem of QGroundControl, parse_mission_planner_line of MAVSDK, mavwp of
//     pymavlink
#pragma once

#include <string>
#include <vector>

namespace lapwing {

// What a loader would refuse, or silently take for something else; empty for a good file.
std::vector<std::string> plan_faults(const std::string& text);
std::vector<std::string> waypoints_faults(const std::string& text);

}  // namespace lapwing
