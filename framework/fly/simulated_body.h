// SPDX-License-Identifier: Apache-2.0
// The full quadrotor under an autopilot's own controllers, which know setpoints and no plan.
//
// Cascaded as PX4 has it: the error of place, its integral and the error of velocity, with velocity
// and acceleration fed forward, ask for a thrust; its direction and the yaw are an attitude, which
// Lee's law (vehicle/flight_controller.h) holds. Gains are those of the vehicle (`gains_of`).
#pragma once

#include "framework/fly/plan_pacer.h"
#include "framework/vehicle/flight_controller.h"

namespace lapwing {

class SimulatedBody {
 public:
  static constexpr double kStep = 0.002;  // s

  // At rest, hovering. Keeps a reference. Throws InputError for a vehicle without rotors.
  SimulatedBody(const Vehicle& vehicle, const Eigen::Vector3d& position, double yaw);

  // A new setpoint.
  void aim(const Setpoint& setpoint);
  // One step of the controllers and of the body.
  void advance();

  const BodyState& state() const { return state_; }
  double yaw() const;
  const Setpoint& setpoint() const { return setpoint_; }

 private:
  Eigen::Vector3d fed_force() const;
  const Vehicle& vehicle_;
  RotorBody body_;
  ControllerGains gains_;
  RotorAllocation allocation_;
  BodyState state_;
  Setpoint setpoint_;
  Eigen::Vector3d integral_ = Eigen::Vector3d::Zero();  // m s
  Eigen::Vector3d forward_ = Eigen::Vector3d::Zero();   // m/s^2, smoothed acceleration
  Eigen::Quaterniond planned_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rates_ = Eigen::Vector3d::Zero();  // rad/s, of `planned_`
  double turning_ = 0;                               // rad/s^2, of its yaw
  int steps_ = 0;                                    // since the last setpoint
  bool saturated_ = false, regular_ = false;
};

}  // namespace lapwing
