// Drawings of a flight: its path, its motion, its inputs.
#pragma once

#include <vector>

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// The axis that all charts and drawings of a flight share.
Axis time_axis();

// Path from above, from the side that shows more of it, and in space, coloured by speed.
Section path_section(const Plan& plan);
// Position, speeds and accelerations against the vehicle's limits; of a `path`, position alone.
Section motion_section(const Plan& plan, const Vehicle& vehicle);
// Thrust and yaw torque (model force) or rotor thrusts (model rotors); empty for a `path`.
Section input_section(const Plan& plan, const Vehicle& vehicle);
// Yaw and, where the trajectory has it, the gimbal: angles and rates, in degrees.
Section direction_section(const Plan& plan, const Vehicle& vehicle);

}  // namespace lapwing
