// SPDX-License-Identifier: Apache-2.0
// A vehicle file as a Value, the way YAML reading gives it.
#pragma once

#include "framework/core/json.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

inline Value vehicle_file() {
  return from_json(R"({
    "mass": 1.5,
    "inertia": [0.015, 0.015, 0.025],
    "rotors": {"thrust": [0.2, 8.0], "torque_coefficient": 0.016, "arm_length": 0.23,
               "layout": "diagonal"},
    "yaw_share": 0.2,
    "limits": {"speed_across": "36 km/h", "climb_speed": 2.5, "descent_speed": 2.0,
               "acceleration_across": 4.0, "yaw_rate_deg": 90},
    "flight_time": "20 min",
    "gimbal": {"yaw_deg": [0, 0], "yaw_rate_deg": 0, "pitch_deg": [-90, 0], "pitch_rate_deg": 90},
    "camera": "cameras/action"
  })",
                   "solo.yaml");
}

inline Value camera_file() {
  return from_json(R"({"image_size": [1920, 1080], "focal_length": [890, 890],
                       "principal_point": [959.5, 539.5]})",
                   "action.yaml");
}

inline Vehicle read_vehicle(const Value& vehicle, const Value& camera = camera_file()) {
  return vehicle_from(check(vehicle_table(), vehicle), check(camera_table(), camera), "solo");
}

}  // namespace lapwing
