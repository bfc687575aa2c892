// SPDX-License-Identifier: Apache-2.0
// What a vehicle file states: body, rotors, limits, gimbal, camera. SI, radians.
//
// The body is a rigid quadrotor; the limits are those of the vehicle, whatever a problem asks for.
// The verifier judges every plan against them.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "framework/core/parameters.h"
#include "framework/geometry/camera_view.h"
#include "framework/vehicle/disturbances.h"

namespace lapwing {

struct Rotors {
  double thrust_max = 0;          // N, one rotor (F_max of thesis 3.8.3)
  double thrust_min = 0;          // N, one rotor
  double torque_coefficient = 0;  // m, drag torque = coefficient * thrust (k_M / k_F)
  double arm_length = 0;          // m, rotor axis to centre of mass
  double lag = 0;                 // s, time constant of thrust after its command
  bool diagonal = false;  // arms at 45 degrees to the body axes; else along them (fig. 3.11)
};

struct GimbalLimits {
  double yaw_min = 0, yaw_max = 0;      // rad, relative to the body; equal when it cannot turn
  double pitch_min = 0, pitch_max = 0;  // rad, positive up
  double yaw_rate_max = 0;              // rad/s
  double pitch_rate_max = 0;            // rad/s
};

// What a wing can do, in still air (model `fixed_wing`).
struct Wing {
  double stall_speed = 0;    // m/s, airspeed in straight flight below which it does not carry
  double bank_max = 0;       // rad
  double bank_rate_max = 0;  // rad/s
  // m/s^2, smallest and largest (thrust - drag) / mass: what speeds it up or lifts it.
  double excess_thrust_min = 0, excess_thrust_max = 0;
};

struct Camera {
  std::string name;
  int width = 0, height = 0;                // pixels
  double focal_x = 0, focal_y = 0;          // pixels
  double principal_x = 0, principal_y = 0;  // pixels, from the upper left corner's centre

  Pinhole pinhole() const { return {width, height, focal_x, focal_y, principal_x, principal_y}; }
};

struct Vehicle {
  std::string name;
  double mass = 0;         // kg
  bool has_rotors = true;  // else inertia, rotors and yaw_share are unknown, and zero
  Eigen::Vector3d inertia = Eigen::Vector3d::Zero();  // kg m^2, body axes, diagonal
  double drag = 0;                                    // N s/m, linear in the airspeed
  Rotors rotors;
  double yaw_share = 0;  // beta of 3.8.3: share of the largest yaw moment that is kept usable
  double speed_across_max = 0;                  // m/s, horizontal
  double climb_speed_max = 0;                   // m/s
  double descent_speed_max = 0;                 // m/s
  double acceleration_across_max = 0;           // m/s^2, horizontal
  std::optional<double> acceleration_up_max;    // m/s^2; absent: the rotors alone limit it
  std::optional<double> acceleration_down_max;  // m/s^2
  std::optional<double> jerk_max;               // m/s^3, norm; absent: nothing limits it
  double yaw_rate_max = 0;                      // rad/s
  std::optional<double> tilt_rate_max;          // rad/s, about x and y; absent: rotors limit it
  double flight_time = 0;                       // s on one battery
  std::optional<Wing> wing;
  std::optional<GimbalLimits> gimbal;
  Camera camera;
  // What its plans are flown with: a controller's name, or a map of `type` and parameters; null:
  // the thesis's (controller.h).
  Value controller;
  Disturbances disturbances;  // of its flights in simulation, beside those that are asked for

  // Bounds of thesis 3.8.3 with the lower one that its statement needs (README.md, reading 3.2):
  // every thrust norm in [thrust_min, thrust_max] together with every |yaw torque| up to
  // yaw_torque_max keeps each rotor within its limits, with no roll or pitch moment.
  double thrust_max() const;      // N, (1 - beta/2) 4 F_max
  double thrust_min() const;      // N, (beta/2) 4 F_max + 4 F_min
  double yaw_torque_max() const;  // N m, beta 2 M_max
  // m/s^2 that the vehicle can accelerate upwards and downwards: what its file states and what its
  // rotors give, whichever is less.
  double largest_acceleration_up() const;
  double largest_acceleration_down() const;
};

// The table of a vehicle file and of a camera file; angles in degrees, in keys that end in _deg.
ParameterTable vehicle_table();
ParameterTable camera_table();

// Throws InputError with everything that contradicts itself: limits, body, gimbal, camera, or a
// vehicle that cannot hover between thrust_min and thrust_max. A file without rotors states how
// fast the vehicle accelerates upwards and downwards.
Vehicle vehicle_from(const Parameters& vehicle, const Parameters& camera, std::string name);

// Round trip through a plan, SI and radians. `vehicle_from_value` throws InputError listing every
// missing, misspelt, mistyped or non-finite field, and every contradiction.
Value to_value(const Vehicle& vehicle);
Vehicle vehicle_from_value(const Value& value);
// Its `limits` alone: those that it states, by the names of vehicle files, SI and radians.
Value limits_to_value(const Vehicle& vehicle);

}  // namespace lapwing
