// SPDX-License-Identifier: Apache-2.0
// The way from where the vehicle is to the plan's start.
#pragma once

#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// A straight way from rest at `position` (m, world) and `yaw` (rad) to rest at the first sample of
// `plan`, in 1 s at least: at up to 1 m/s, 1 m/s^2, and half of each limit of the vehicle.
Trajectory settling_way(const Eigen::Vector3d& position, double yaw, const Trajectory& plan,
                        const Vehicle& vehicle);

}  // namespace lapwing
