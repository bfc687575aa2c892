// SPDX-License-Identifier: Apache-2.0
// A mesh from points with normals: what a first flight saw, for planning the second (reading 4.9).
#pragma once

#include "framework/core/progress.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/surface/point_fusion.h"

namespace lapwing {

// How the field is made whose zeros are the surface.
enum class SurfaceMethod {
  poisson,  // one field through all points; closes gaps, and takes longer than in proportion
  local     // each place from the points around it; takes time in proportion, on all threads
};

struct SurfaceOptions {
  double cell = 0.2;  // m, edge of the cells in which triangles are made
  double trim =
      0.4;  // m, at most 20 cells; surface farther from every point is guesswork, left out
  SurfaceMethod method = SurfaceMethod::poisson;
  int threads = 1;
};

// The zero surface of a field, cut into triangles cell by cell; they turn counter-clockwise as seen
// from the side of the normals. The field is the Poisson reconstruction (Kazhdan and others 2006)
// by CGAL, or, at each place, the mean height above the planes of the points around it, weighted by
// exp(-(distance / cell)^2) (implicit moving least squares: Kolluri, "Provably good moving least
// squares", 2005, eq. 1). The same points give the same mesh, for any number of threads. Throws
// InputError for fewer than 10 points, points or normals that are not finite, points that span no
// volume, options that are not above 0, or cells without number; Cancelled when told to stop.
TriangleMesh surface_from_points(const std::vector<FusedPoint>& points,
                                 const SurfaceOptions& options,
                                 const CancellationToken* cancellation = nullptr);

}  // namespace lapwing
