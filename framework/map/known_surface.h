// SPDX-License-Identifier: Apache-2.0
// How much surface a region has, as far as a map and a mesh know it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/geometry/interest_region.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/map/voxel.h"

namespace lapwing {

// What views tell of a voxel, from 0 (nothing) to 1 (all).
struct VoxelShare {
  VoxelKey voxel;
  float share = 0;
};

// What views tell of a triangle, from 0 to 1, or why there is nothing to tell.
inline constexpr float kOutsideRegion = -2, kNeverVisible = -1;

// For each triangle of the mesh: kOutsideRegion where its middle is not in the region;
// kNeverVisible where none of the voxels is listed through which a short line along its normal
// passes, two voxels to either side; else the largest share of those that are. `voxels`
// in any order, each key once.
std::vector<float> shares_of_triangles(const TriangleMesh& mesh, const InterestRegion& region,
                                       const VoxelGrid& grid, std::vector<VoxelShare> voxels,
                                       int threads = 1);

struct SurfaceAreas {
  double known = 0;    // m^2 of the mesh in the region
  double visible = 0;  // m^2 of it that some listed voxel belongs to
  double seen = 0;     // m^2 of it of which more than nothing is told
  // m^2 of the mesh over and under the region, of triangles whose middles lie in its footprint
  double above = 0, below = 0;
};

// Of what shares_of_triangles says for the same region.
SurfaceAreas areas_of(const TriangleMesh& mesh, std::span<const float> shares,
                      const InterestRegion& region);

}  // namespace lapwing
