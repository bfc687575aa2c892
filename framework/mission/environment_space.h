// SPDX-License-Identifier: Apache-2.0
// The environment of a flight as a space to plan ways in.
#pragma once

#include <memory>
#include <vector>

#include "framework/path/free_space.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

// Free where obstacles that stand still, and the faces of flight zones, are farther than the
// environment's margin and `more` metres, and balls than `more`; subjects are no obstacles. Bodies
// that move are grown by half their diagonal; boxes at rest are judged to 0.15 m. Copies what it
// needs.
struct KeptBall {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double distance = 0;  // m, kept from the centre
};
std::unique_ptr<FreeSpace> free_space_of(const Environment& environment,
                                         std::vector<KeptBall> balls, double more);

}  // namespace lapwing
