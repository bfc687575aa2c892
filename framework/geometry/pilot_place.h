// SPDX-License-Identifier: Apache-2.0
// Where somebody stands who must see the vehicle during the whole flight.
#pragma once

#include <Eigen/Core>

namespace lapwing {

struct PilotPlace {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  // m, world
  double range = 500;                             // m, largest distance of the vehicle from the eye
  // m from the eye, within which nothing hides the vehicle: there the pilot stands.
  double beside = 1;

  bool operator==(const PilotPlace&) const = default;
};

}  // namespace lapwing
