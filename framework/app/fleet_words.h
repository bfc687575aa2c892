// SPDX-License-Identifier: Apache-2.0
// A fleet in words, for the terminal.
#pragma once

#include <string>

#include "framework/trajectory/fleet.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// "5 tours of 2 drones, 3 changes of batteries, 840 s in all".
std::string fleet_in_words(const Fleet& fleet, double end);
// "drone 1, battery 2: begins at 360 s, 295 s of flight, 41 images, certified: plan_3.json".
std::string tour_in_words(const FleetTour& tour, const Plan& plan, bool certified);

}  // namespace lapwing
