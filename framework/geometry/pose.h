// SPDX-License-Identifier: Apache-2.0
// Where a camera or a vehicle is and which way it is turned, in the world.
#pragma once

#include <Eigen/Geometry>

namespace lapwing {

struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  // Takes the frame of the body to the world; a unit quaternion. Of a camera: x right, y down, z
  // forward.
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

}  // namespace lapwing
