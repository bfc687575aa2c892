// SPDX-License-Identifier: Apache-2.0
// How much of a true surface images see: for judging a scan in simulation. Planning knows nothing
// of it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "framework/geometry/interest_region.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

// Places spread evenly over the surface in a region, on both of its sides. Those count from which a
// straight line leads out of the box `room` through a side or the top of it: inner rooms, and what
// faces the ground, cannot be seen by who flies.
class TrueSurface {
 public:
  // The same for any number of threads. InputError for a region without such a surface.
  TrueSurface(std::shared_ptr<const MeshScene> scene, const InterestRegion& region,
              const Eigen::AlignedBox3d& room, int threads);

  double area() const;  // m^2, of all places that count
  // m^2 that one of the views has in its image, within `range` metres, at less than 80 degrees from
  // the normal, and not behind anything. The same for any number of threads.
  double seen(std::span<const Viewpoint> views, const Pinhole& pinhole, double range,
              int threads) const;

 private:
  struct Place {
    Eigen::Vector3d position;  // m
    Eigen::Vector3d normal;    // unit, of this side
  };

  std::shared_ptr<const MeshScene> scene_;
  std::vector<Place> places_;
  double area_of_place_ = 0;  // m^2
};

}  // namespace lapwing
