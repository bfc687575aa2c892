// SPDX-License-Identifier: Apache-2.0
// A path without inputs, such as an exploration is stored as, as a flight that a controller
// follows.
#pragma once

#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// The places of the path in turn, with a stop in each and the heading stated there, by pursuit.h:
// as fast as the path's quickest leg, within the vehicle's limits, and with the path's longest
// pause in every place. It takes longer than the path says, which knows no acceleration. The
// camera's angles are those of the path where the vehicle is. Throws InputError for a path without
// length and for a vehicle without rotors.
Trajectory flight_along(const Trajectory& path, const Vehicle& vehicle);

}  // namespace lapwing
