// SPDX-License-Identifier: Apache-2.0
// Zones of a plan as fences, which reach from the ground to the sky.
#pragma once

#include <string>
#include <vector>

#include "framework/export/mission_items.h"

namespace lapwing {

// Of flight zones and zones as polygons, of balls and upright cylinders as circles. What the flight
// passes above or below is left out, because a fence has no height; `said` takes a sentence on it.
std::vector<MissionFence> mission_fences(const Plan& plan, std::vector<std::string>& said);

}  // namespace lapwing
