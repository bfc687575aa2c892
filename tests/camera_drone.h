// SPDX-License-Identifier: Apache-2.0
// The vehicle of most tests.
#pragma once

#include <string>

#include "framework/vehicle/vehicle.h"

namespace lapwing {

// A 1.5 kg camera drone with the speeds of thesis 3.8.3; without gimbal and camera.
inline Vehicle camera_drone(const std::string& name = "drone") {
  Vehicle vehicle;
  vehicle.name = name;
  vehicle.mass = 1.5;
  vehicle.inertia = {0.015, 0.015, 0.025};
  vehicle.rotors.thrust_max = 8;
  vehicle.rotors.thrust_min = 0.2;
  vehicle.rotors.torque_coefficient = 0.016;
  vehicle.rotors.arm_length = 0.23;
  vehicle.rotors.diagonal = true;
  vehicle.yaw_share = 0.2;
  vehicle.speed_across_max = 10;
  vehicle.climb_speed_max = 2.5;
  vehicle.descent_speed_max = 2;
  vehicle.acceleration_across_max = 4;
  vehicle.yaw_rate_max = 1.5;
  vehicle.flight_time = 1200;
  return vehicle;
}

}  // namespace lapwing
