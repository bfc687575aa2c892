// SPDX-License-Identifier: Apache-2.0
// The attitude that forces and headings of a reference ask for, with its first two derivatives.
#pragma once

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

}  // namespace lapwing
