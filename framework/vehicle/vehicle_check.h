// SPDX-License-Identifier: Apache-2.0
// What every vehicle must satisfy, wherever its numbers come from.
#pragma once

#include <functional>
#include <string>

#include "framework/vehicle/vehicle.h"

namespace lapwing {

// Calls `add(key, message)` for everything that contradicts itself. Keys are those of a vehicle
// file ("limits.climb_speed", "rotors.thrust"), the camera's behind "camera.".
void check_vehicle(const Vehicle& vehicle,
                   const std::function<void(const std::string&, const std::string&)>& add);

}  // namespace lapwing
