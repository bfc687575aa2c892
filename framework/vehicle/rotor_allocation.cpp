// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/rotor_allocation.h"

#include <algorithm>

#include <Eigen/LU>

#include "framework/vehicle/rotor_body.h"

namespace lapwing {

using Eigen::Vector4d;

RotorAllocation::RotorAllocation(const Vehicle& vehicle)
    : least_(vehicle.rotors.thrust_min),
      most_(vehicle.rotors.thrust_max),
      unmix_(mixer_of(vehicle.rotors).inverse()) {}

RotorCommand RotorAllocation::operator()(const Vector4d& wrench) const {
  RotorCommand command;
  command.thrusts = unmix_ * wrench;
  if (command.thrusts.minCoeff() >= least_ && command.thrusts.maxCoeff() <= most_) return command;
  command.saturated = true;
  Vector4d tilting = unmix_.col(1) * wrench(1) + unmix_.col(2) * wrench(2);
  const double spread = tilting.maxCoeff() - tilting.minCoeff();
  if (spread > most_ - least_) tilting *= (most_ - least_) / spread;
  const double low = least_ - tilting.minCoeff();
  const double high = std::max(low, most_ - tilting.maxCoeff());
  const double each = std::clamp(wrench(0) / 4, low, high);
  const Vector4d level = tilting + Vector4d::Constant(each);
  const Vector4d yaw = unmix_.col(3) * wrench(3);
  double share = 1;
  for (int i = 0; i < 4; ++i) {
    const double room = yaw(i) > 0 ? most_ - level(i) : least_ - level(i);
    if (yaw(i) != 0) share = std::min(share, std::max(0.0, room / yaw(i)));
  }
  command.thrusts = (level + share * yaw).cwiseMax(least_).cwiseMin(most_);
  return command;
}

}  // namespace lapwing
