// SPDX-License-Identifier: Apache-2.0
// What a depth camera measures.
#pragma once

#include <vector>

#include "framework/geometry/camera_view.h"
#include "framework/geometry/pose.h"

namespace lapwing {

// Depth along the optical axis, not along the ray, in metres: rows from the top, pixels from the
// left, `pinhole.width * pinhole.height` numbers. 0 is no measurement; infinity is a ray that
// found nothing within the sensor's reach, so that it is free up to there.
struct DepthImage {
  Pinhole pinhole;
  std::vector<float> depth;

  float at(int x, int y) const { return depth[static_cast<std::size_t>(y) * pinhole.width + x]; }
};

// An image and where its camera was.
struct PosedDepthImage {
  Pose camera;
  DepthImage image;
};

}  // namespace lapwing
