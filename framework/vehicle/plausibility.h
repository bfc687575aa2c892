// SPDX-License-Identifier: Apache-2.0
// Whether a vehicle could be a real one: multirotors from 10 g to 1000 kg.
//
// What is far outside is a slip of units, and would come back later as a solver or a controller
// that fails. Bounds are wide: each names what real vehicles have, with room on either side.
#pragma once

#include <functional>
#include <string>

#include "framework/vehicle/vehicle.h"

namespace lapwing {

// Calls `add(key, message)` for every figure that no multirotor has, with the unit that would make
// it one where there is such a unit. Keys as of check_vehicle. Expects figures that are finite and
// have the right sign.
void check_plausible(const Vehicle& vehicle,
                     const std::function<void(const std::string&, const std::string&)>& add);

}  // namespace lapwing
