// SPDX-License-Identifier: Apache-2.0
// Drawings of a flight: its path, its motion, its inputs.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "framework/export/time_charts.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// Path from above, from the side that shows more of it, and in space, coloured by speed.
// `folder` holds the meshes of its environment.
Section path_section(const Plan& plan, const std::filesystem::path& folder);
// The paths of several plans, each by its name, in one picture, with the task and the surroundings
// of the first, whose meshes lie in `folder`.
Section paths_section(const std::vector<std::pair<std::string, const Plan*>>& plans,
                      const std::filesystem::path& folder);
// All that is drawn beside a path: what the flight was asked for, and what surrounds it, with the
// bystanders and the distances kept from them. `folder` holds the meshes of its environment.
void add_task(const Plan& plan, const std::filesystem::path& folder, Drawing& drawing);
// Position, speeds and accelerations against the vehicle's limits; of a `path`, position alone.
Section motion_section(const Plan& plan, const Vehicle& vehicle);
// Thrust and yaw torque (model force) or rotor thrusts (model rotors); empty for a `path`.
Section input_section(const Plan& plan, const Vehicle& vehicle);
// Yaw and its rate, in degrees.
Section direction_section(const Plan& plan, const Vehicle& vehicle);

}  // namespace lapwing
