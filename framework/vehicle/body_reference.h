// SPDX-License-Identifier: Apache-2.0
// The whole motion of a plan, as a controller may follow it: place, attitude, rates, thrusts.
#pragma once

#include <memory>
#include <vector>

#include "framework/vehicle/reference_motion.h"
#include "framework/vehicle/rotor_body.h"

namespace lapwing {

struct BodyPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m, world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();               // m/s, world
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();           // m/s^2, world
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // R_WB
  Eigen::Vector3d body_rates = Eigen::Vector3d::Zero();             // rad/s, body
  Eigen::Vector3d body_accelerations = Eigen::Vector3d::Zero();     // rad/s^2, body
  Eigen::Vector4d rotor_thrusts = Eigen::Vector4d::Zero();          // N; may lie beyond limits
};

// Of a plan that states attitude and rotor thrusts (`rotors`): what it states, between samples
// integrated from its thrusts, with the mismatch at the next sample taken up evenly. Of other
// plans: the attitude of force and heading (planned_attitude.h) and the thrusts that turn it so,
// which no limit is applied to.
class BodyReference {
 public:
  // Keeps references. Throws as ReferenceMotion does.
  BodyReference(const Trajectory& trajectory, const Vehicle& vehicle);

  const ReferenceMotion& motion() const { return motion_; }
  double start() const { return motion_.start(); }
  double finish() const { return motion_.finish(); }
  // Whether the plan states attitudes itself, and with them may fly upside down.
  bool states_attitude() const { return !states_.empty(); }

  // Times before the start and after the end: as at the start, as at the end.
  BodyPoint at(double time) const;

  // In the state that the plan begins with.
  BodyState starting_state() const;

 private:
  Eigen::Vector4d thrusts(std::size_t interval, double time) const;
  void integrate();

  const Trajectory& trajectory_;
  ReferenceMotion motion_;
  double mass_, drag_;
  Eigen::Vector3d inertia_;
  Eigen::Matrix4d unmix_;
  std::unique_ptr<RotorBody> body_;  // whose rotors answer at once
  std::vector<double> times_;        // of states_
  std::vector<std::size_t> intervals_;
  std::vector<BodyState> states_;
};

}  // namespace lapwing
