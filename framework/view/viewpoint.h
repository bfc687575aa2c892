// SPDX-License-Identifier: Apache-2.0
// Where a picture is taken.
#pragma once

#include "framework/geometry/depth_camera.h"

namespace lapwing {

// A level camera; roll is 0.
struct Viewpoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  double yaw = 0;                                      // rad
  double pitch = 0;                                    // rad, positive up

  Pose camera() const { return camera_pose(position, yaw, pitch); }
  // Unit, world.
  Eigen::Vector3d direction() const {
    return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
  }
};

// rad, between the directions of two viewpoints; also where they coincide or are opposite.
inline double angle_between(const Viewpoint& a, const Viewpoint& b) {
  const Eigen::Vector3d p = a.direction(), q = b.direction();
  return std::atan2(p.cross(q).norm(), p.dot(q));
}

}  // namespace lapwing
