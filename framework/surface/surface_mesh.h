// SPDX-License-Identifier: Apache-2.0
// A mesh from points with normals: what a first flight saw, for planning the second (reading 4.9).
#pragma once

#include "framework/geometry/triangle_mesh.h"
#include "framework/surface/point_fusion.h"

namespace lapwing {

struct SurfaceOptions {
  double cell = 0.2;  // m, edge of the cells in which triangles are made
  double trim =
      0.4;  // m, at most 20 cells; surface farther from every point is guesswork, left out
};

// Poisson reconstruction (Kazhdan and others 2006) by CGAL, its zero surface cut into triangles
// cell by cell; they turn counter-clockwise as seen from the side of the normals. The same points
// give the same mesh. Throws InputError for fewer than 10 points, points or normals that are not
// finite, points that span no volume, options that are not above 0, or cells without number.
TriangleMesh surface_from_points(const std::vector<FusedPoint>& points,
                                 const SurfaceOptions& options);

}  // namespace lapwing
