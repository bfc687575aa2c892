// SPDX-License-Identifier: Apache-2.0
// The rays of a view through what a map knows: what hand-made utilities count along.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "framework/core/error.h"
#include "framework/explore/view_utility.h"
#include "framework/map/ray_walk.h"

namespace lapwing {

// Unit vectors in the world through every `pixel_step`-th pixel of every such row, beginning in the
// middle of the first such square of pixels. InputError for a step that passes all pixels by.
inline std::vector<Eigen::Vector3d> view_rays(const Viewpoint& view, const Pinhole& pinhole,
                                              int pixel_step) {
  const Eigen::Matrix3d to_world = view.camera().orientation.toRotationMatrix();
  const double first = (pixel_step - 1) / 2.0;
  const int smaller = std::min(pinhole.width, pinhole.height);
  if (first > smaller - 1)
    throw InputError("pixel_step " + std::to_string(pixel_step) + " passes by all pixels of an " +
                     "image of " + std::to_string(pinhole.width) + " x " +
                     std::to_string(pinhole.height) + ": expected at most " +
                     std::to_string(2 * smaller - 1));
  std::vector<Eigen::Vector3d> rays;
  for (double y = first; y <= pinhole.height - 1; y += pixel_step)
    for (double x = first; x <= pinhole.width - 1; x += pixel_step)
      rays.push_back(to_world * pixel_ray(pinhole, x, y).normalized());
  return rays;
}

// Voxel by voxel from the camera on: `visit(reading, distance)` with the distance at which the ray
// enters the voxel, m, until it returns false, the range ends or the ray leaves the largest map.
template <class Visit>
void walk_ray(const Map& map, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
              double range, Visit visit) {
  if (!map.grid().contains(origin)) return;
  RayWalk walk(map.grid(), origin, direction);
  while (walk.inside() && walk.entered < range) {
    if (!visit(map.read(walk.key()), walk.entered)) return;
    walk.advance();
  }
}

}  // namespace lapwing
