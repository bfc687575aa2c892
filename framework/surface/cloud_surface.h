// SPDX-License-Identifier: Apache-2.0
// Points of a surface with normals, from a cloud of points without directions.
#pragma once

#include <vector>

#include "framework/surface/point_fusion.h"
#include "framework/surface/thinned_cloud.h"

namespace lapwing {

struct CloudSurfaceSettings {
  double spacing = 0.4;  // m, edge of the cubes that give a point each
  std::vector<Eigen::Vector3d> scanners =
      {};  // m, world: from where the cloud was measured, if known
  int threads = 1;
};

struct CloudSurface {
  std::vector<FusedPoint> points;  // in the order of their places
  // Of the thinned points, whether they are part of it: not so alone that they are taken for noise.
  std::vector<bool> kept;
  std::size_t alone = 0;  // thinned points that are not
};

// A cube's point is the mean of its thinned points. A cube with fewer than three others within
// three cubes along each axis is noise.
//
// Normals are those of the thinned points where they have some, else across the plane that fits the
// points within two cubes best (three cubes, where there are fewer than six). They face the nearest
// scanner. Without scanners they face the open sky: the side on which there are more places above
// all points of their column. Where both sides are alike a normal follows its neighbours, and at
// last the file or the upward direction.
//
// The same for any number of threads. InputError for fewer than 10 points, and where more than half
// of the cubes would be noise.
CloudSurface surface_of_cloud(const std::vector<ThinnedPoint>& thinned,
                              const CloudSurfaceSettings& settings);

}  // namespace lapwing
