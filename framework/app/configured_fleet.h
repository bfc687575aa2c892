// SPDX-License-Identifier: Apache-2.0
// What the configuration of a fleet's plans says of the fleet.
#pragma once

#include <span>

#include "framework/app/configured_task.h"
#include "framework/trajectory/fleet.h"

namespace lapwing {

// Compares separation, swap, reserve, the share that must be seen again, and the numbers of drones
// and batteries with the configuration, which all plans must share. A fleet may ask for more.
// `plans`: one per tour, in the fleet's order.
ConfigurationComparison compare_fleet(const Fleet& fleet, std::span<const Plan* const> plans);

}  // namespace lapwing
