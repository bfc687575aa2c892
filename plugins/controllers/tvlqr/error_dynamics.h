// SPDX-License-Identifier: Apache-2.0
// How small deviations from a plan move: the quadrotor of (3.12), (3.13), linearised.
#pragma once

#include <Eigen/Core>

#include "framework/vehicle/body_reference.h"

namespace lapwing {

// The deviation x from the plan, and its input u:
//   0  integral of the position's deviation, m s, world
//   3  position, m, world
//   6  velocity, m/s, world
//   9  attitude, rad: R = R_d exp(x^), body
//  12  body rates, rad/s, body
//  15  rotor thrusts, N; u is the commands' deviation, N. Rotors without lag have no such states:
//      u is the thrusts' own deviation
constexpr int kBodyErrors = 15, kRotorErrors = 4;

struct ErrorDynamics {
  Eigen::MatrixXd a, b;  // x' = a x + b u
};

// About one point of a plan. Whether there are rotor states: vehicle.rotors.lag > 0.
ErrorDynamics error_dynamics(const BodyPoint& point, const Vehicle& vehicle);

// The deviation of a state, with the integral's as given.
Eigen::VectorXd deviation(const BodyState& state, const BodyPoint& point,
                          const Eigen::Vector3d& integral, bool with_rotors);

}  // namespace lapwing
