// SPDX-License-Identifier: Apache-2.0
// A turn, a scale and a shift: from the frame of a model made of photographs to the world.
#pragma once

#include "framework/geometry/depth_image.h"

namespace lapwing {

struct Similarity {
  double scale = 1;                                              // m of the world per unit
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         // m, world

  Eigen::Vector3d apply(const Eigen::Vector3d& p) const {
    return scale * (rotation * p) + translation;
  }
  Pose apply(const Pose& pose) const {
    return {apply(pose.position), (rotation * pose.orientation).normalized()};
  }
  Eigen::Vector3d inverse(const Eigen::Vector3d& p_W) const {
    return rotation.conjugate() * (p_W - translation) / scale;
  }
};

}  // namespace lapwing
