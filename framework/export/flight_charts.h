// Drawings of a flight: its path, its motion, its inputs.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/export/time_charts.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// Path from above, from the side that shows more of it, and in space, coloured by speed.
// `folder` holds the meshes of its environment.
Section path_section(const Plan& plan, const std::filesystem::path& folder);
// Position, speeds and accelerations against the vehicle's limits; of a `path`, position alone.
Section motion_section(const Plan& plan, const Vehicle& vehicle);
// Thrust and yaw torque (model force) or rotor thrusts (model rotors); empty for a `path`.
Section input_section(const Plan& plan, const Vehicle& vehicle);
// Yaw and its rate, in degrees.
Section direction_section(const Plan& plan, const Vehicle& vehicle);

}  // namespace lapwing
