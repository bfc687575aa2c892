// SPDX-License-Identifier: Apache-2.0
// Where a map ends within a region: openings behind which surface hides that nobody saw.
#pragma once

#include <vector>

#include "framework/geometry/interest_region.h"
#include "framework/map/map.h"
#include "framework/map/ray_gaps.h"

namespace lapwing {

// A connected part of the edge of what was measured.
struct Opening {
  double area = 0;  // m^2
  // m, world: a voxel of it, near the middle of the largest part that looks one way along an axis;
  // where it is passable, of the parts that are.
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  bool passable = false;         // see EdgeSettings::width
  std::vector<VoxelKey> voxels;  // never measured, air beside them
};

struct EdgeSettings {
  InterestRegion region;
  MapRays rays;
  // m. An opening is passable where a sphere so wide fits behind it, and has room when its middle
  // is in it: to 1.5 voxels, farther from all known surface than its radius.
  double width = 0;
  int threads = 1;
};

// Openings of one voxel's face at least, largest first: where air of the region meets voxels that
// no ray came to. Three things are no openings:
//   - what lies beside a voxel with a surface in it, or within one and a half voxels of `mesh`,
//     which may be null;
//   - gaps between rays: never measured voxels that no sphere holds which is as wide as the gap
//     between rays there (ray_gaps.h) and a voxel's diagonal (a ray that touches a voxel passes its
//     middle within half of that). They count as measured air where such a sphere's radius leads to
//     air;
//   - specks of fewer than eight faces.
// Surface that nobody saw hides behind an opening. A plane over a corner that was not looked into
// has at most the area of the corner's sides, so that areas are lower bounds of what hides. Faces
// are added as vectors in cubes of 8 x 8 x 8 voxels, so that a slope counts as a slope and not as
// stairs. Parts of the edge are one opening where their voxels touch, at corners too.
//
// The same for any number of threads. InputError for a region of more than 2^28 voxels.
std::vector<Opening> unknown_openings(const Map& map, const MeshScene* mesh,
                                      const EdgeSettings& settings);

}  // namespace lapwing
