// SPDX-License-Identifier: Apache-2.0
// The animated node of a .glb file, read from its bytes as a player does.
#pragma once

#include <string>
#include <vector>

#include "framework/geometry/pose.h"

namespace lapwing::gltf_file {

struct AnimatedNode {
  std::vector<double> times;  // s
  std::vector<Eigen::Vector3d> places;
  std::vector<Eigen::Quaterniond> turns;
  // Between keys places are straight and turns even along the shorter arc. In the world of the
  // plan: z up, of a camera with x right, y down, z forward.
  Pose at(double time) const;
};

// The first node of the document. Throws Error where the bytes hold no animation of it.
AnimatedNode animated_node(const std::string& file);

}  // namespace lapwing::gltf_file
