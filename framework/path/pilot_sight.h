// SPDX-License-Identifier: Apache-2.0
// Where a pilot sees a vehicle, as a space to plan ways in.
#pragma once

#include <memory>

#include "framework/geometry/pilot_place.h"
#include "framework/path/free_space.h"

namespace lapwing {

// m, kept beside lines of sight and within the range: flights leave their ways by less.
inline constexpr double kSightRoom = 0.3;

// Free where the line of sight from the pilot's eye passes known free voxels of the map alone,
// kSightRoom to every side, and the vehicle's middle is within the range less kSightRoom. Unknown
// voxels hide the vehicle. The size of a body does not matter. Along ways the line is tried every
// half voxel; between two tries it stays within kSightRoom. Shares the map with the caller.
std::unique_ptr<FreeSpace> in_sight_of(std::shared_ptr<const Map> map, const PilotPlace& pilot);

}  // namespace lapwing
