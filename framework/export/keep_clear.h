// SPDX-License-Identifier: Apache-2.0
// Moves waypoints so that the lines between them keep the distances that a plan keeps.
#pragma once

#include <vector>

#include "framework/export/waypoints.h"

namespace lapwing {

// From obstacles whose shapes are open (margin), from what the flight stays inside of, and from
// subjects that ask for a distance, with 5 cm to spare. Obstacles and subjects are where they are
// when the plan is there. Lines that cannot be freed stay as near as they came.
void keep_clear(std::vector<PlannedWaypoint>& waypoints, const Environment& environment);

}  // namespace lapwing
