// SPDX-License-Identifier: Apache-2.0
// The attitude that forces and headings of a reference ask for, with its first two derivatives.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "framework/vehicle/reference_motion.h"

namespace lapwing {

// The attitude whose z axis is along `force` and whose x axis points to `yaw`. Where the force
// points along the heading itself, the y axis is the one that a level vehicle would have.
Eigen::Quaterniond attitude_of(const Eigen::Vector3d& force, double yaw);

// The rotation vector of a unit quaternion, rad; its norm is at most pi.
Eigen::Vector3d rotation_vector(Eigen::Quaterniond q);

// Attitude with its first two derivatives.
struct AttitudeReference {
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // R_WB
  Eigen::Vector3d body_rates = Eigen::Vector3d::Zero();             // rad/s, body
  Eigen::Vector3d accelerations = Eigen::Vector3d::Zero();          // rad/s^2, body
};

// What the feed-forward of a reference alone asks for; derivatives by differences over 0.01 s.
AttitudeReference planned_attitude(const ReferenceMotion& reference, double time);

// The derivatives of planned attitudes at the equal steps of a flight: the same differences as
// those of planned_attitude, over the whole number of steps that is nearest to 0.01 s, each
// attitude computed once. For one flight at a time; times that rise are quick.
class SteppedAttitudes {
 public:
  // Keeps a reference.
  explicit SteppedAttitudes(const ReferenceMotion& reference) : reference_(reference) {}

  // rad/s, body. `time` (s) lies a whole number of steps (s, above 0) after the reference's start.
  Eigen::Vector3d body_rates(double time, double step);
  // rad/s^2, body. At any time: linear between steps.
  Eigen::Vector3d accelerations(double time, double step);

 private:
  struct Kept {
    std::int64_t index = 0;  // of the step
    bool known = false;
    Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // rad/s, since `apart_` steps before
    bool turns = false;                              // whether `turn` is known
  };

  void divide(double step);
  Kept& kept(std::int64_t index);
  const Eigen::Vector3d& turn(std::int64_t index);
  Eigen::Vector3d acceleration(std::int64_t index);

  const ReferenceMotion& reference_;
  double step_ = 0;
  std::int64_t apart_ = 0;  // steps between the attitudes of a difference
  std::vector<Kept> kept_;  // by index modulo its size
};

}  // namespace lapwing
