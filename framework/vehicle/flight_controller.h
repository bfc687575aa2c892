// SPDX-License-Identifier: Apache-2.0
// The controller that a plan is flown with (thesis 3.8.2): a linear quadratic regulator with
// integral action for the place, (3.14), and Lee's attitude law on SO(3) (CDC 2010) for the rest.
#pragma once

#include "framework/vehicle/reference_motion.h"
#include "framework/vehicle/rotor_allocation.h"
#include "framework/vehicle/rotor_body.h"

namespace lapwing {

struct ControllerGains {
  double integral = 0;                                 // 1/s^3, acceleration per m s
  double position = 0;                                 // 1/s^2
  double velocity = 0;                                 // 1/s
  Eigen::Vector3d attitude = Eigen::Vector3d::Zero();  // N m per rad, K_R
  Eigen::Vector3d rates = Eigen::Vector3d::Zero();     // N m s per rad, K_omega
};

// The attitude loop is critically damped. Its bandwidth w is such that an error of 0.5 rad asks for
// half of the moment that rotors have left beside hovering; at most 20 rad/s about roll and pitch,
// 4 rad/s about yaw, and 0.5 over the rotors' lag. The regulator weighs deviations by what is worth
// an acceleration of 2 m/s^2: 0.1 m, 0.5 m/s, 0.1 m s. Where the attitude answers later than 0.15 s
// (2/w and the lag) all times of the regulator grow in proportion.
ControllerGains gains_of(const Vehicle& vehicle);

// The attitude whose z axis is along `force` and whose x axis points to `yaw`. Where the force
// points along the heading itself, the y axis is the one that a level vehicle would have.
Eigen::Quaterniond attitude_of(const Eigen::Vector3d& force, double yaw);

// Attitude with its first two derivatives.
struct AttitudeReference {
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // R_WB
  Eigen::Vector3d body_rates = Eigen::Vector3d::Zero();             // rad/s, body
  Eigen::Vector3d accelerations = Eigen::Vector3d::Zero();          // rad/s^2, body
};

class FlightController {
 public:
  FlightController(const Vehicle& vehicle, const ReferenceMotion& reference);

  // The command at `time` for a vehicle in this state, `step` seconds after the last call. The
  // integral stands still while rotors are saturated.
  RotorCommand command(double time, const BodyState& state, double step);

  // What the feed-forward alone asks for.
  AttitudeReference attitude(double time) const;
  const ControllerGains& gains() const { return gains_; }

 private:
  const ReferenceMotion& reference_;
  double mass_, lag_;
  Eigen::Vector3d inertia_;
  ControllerGains gains_;
  RotorAllocation allocation_;
  Eigen::Vector3d integral_ = Eigen::Vector3d::Zero();  // m s
  bool saturated_ = false;
};

}  // namespace lapwing
