// SPDX-License-Identifier: Apache-2.0
// The whole quadrotor (thesis 3.8.1): a rigid body with four rotors, in moving air.
//
//   F_i, M_i = k F_i                        rotor i; k is the vehicle's torque coefficient
//   m r'' = u_1 z_B + m g - (d + q |v|) v    (3.12) with linear and quadratic drag d, q; v is the
//                                            airspeed r' - w in the wind w
//   M_B = I omega' + omega x I omega        (3.13)
//
// Rotors are numbered counter-clockwise from above, the first on +x_B or, with diagonal arms,
// between +x_B and +y_B; odd ones drag the body counter-clockwise (3.11). Thrust follows its
// command with a first-order lag.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "framework/vehicle/vehicle.h"

namespace lapwing {

struct BodyState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m, world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();               // m/s, world
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // R_WB
  Eigen::Vector3d body_rates = Eigen::Vector3d::Zero();             // rad/s, body
  Eigen::Vector4d rotor_thrusts = Eigen::Vector4d::Zero();          // N, as they are
};

class RotorBody {
 public:
  // The vehicle as it truly is: `mass_factor` multiplies the mass and the inertia of the file,
  // `inertia_factor` the inertia again; `quadratic_drag` (N s^2/m^2) comes beside the linear one.
  explicit RotorBody(const Vehicle& vehicle, double mass_factor = 1.0, double inertia_factor = 1.0,
                     double quadratic_drag = 0.0);

  // Thrust and moments of (3.11): u_1 in N, u_2 to u_4 in N m, body frame.
  Eigen::Vector4d wrench(const Eigen::Vector4d& rotor_thrusts) const {
    return mixer_ * rotor_thrusts;
  }

  // The state after `step` seconds of these commanded thrusts and this wind (m/s, world), by one
  // step of Runge-Kutta 4, on the rotation group by Munthe-Kaas (BIT Numer. Math. 38, 1998).
  BodyState after(const BodyState& state, const Eigen::Vector4d& commanded,
                  const Eigen::Vector3d& wind, double step) const;

  const Eigen::Matrix4d& mixer() const { return mixer_; }

 private:
  struct Rates;
  Rates rates(const BodyState& state, const Eigen::Vector3d& wind) const;

  double mass_, drag_, quadratic_drag_, lag_;
  Eigen::Vector3d inertia_;
  Eigen::Matrix4d mixer_;
};

// Rows u_1 to u_4 of (3.11), in rotor thrusts instead of squared speeds.
Eigen::Matrix4d mixer_of(const Rotors& rotors);

}  // namespace lapwing
