// SPDX-License-Identifier: Apache-2.0
// Rotor thrusts for a wanted thrust and moment, within the rotors' limits.
#pragma once

#include <Eigen/Core>

#include "framework/vehicle/vehicle.h"

namespace lapwing {

struct RotorCommand {
  Eigen::Vector4d thrusts = Eigen::Vector4d::Zero();  // N, within the limits
  bool saturated = false;                             // the wish could not be met in full
};

// Where not all can be had, the direction of the thrust comes first: yaw moment gives way, then the
// thrust itself, roll and pitch moments last (as Faessler, Falanga, Scaramuzza, RA-L 2(2), 2017,
// order them).
class RotorAllocation {
 public:
  explicit RotorAllocation(const Vehicle& vehicle);

  // `wrench`: u_1 in N, u_2 to u_4 in N m, body frame (3.11).
  RotorCommand operator()(const Eigen::Vector4d& wrench) const;

 private:
  double least_, most_;
  Eigen::Matrix4d unmix_;
};

}  // namespace lapwing
