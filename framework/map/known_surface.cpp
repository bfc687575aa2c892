// SPDX-License-Identifier: Apache-2.0
// How: voxels are sorted by key, so that each is found by bisection. From the centroid of a
// triangle, places along its normal are looked up in steps of half a voxel, up to two voxels to
// either side: the reconstruction may lie that far from the voxels of the surface. The triangle
// takes the largest share of the voxels found. Areas are sums over triangles, by class.
#include "framework/map/known_surface.h"

#include <algorithm>

#include "framework/core/parallel.h"

namespace lapwing {

using Eigen::Vector3d;

std::vector<float> shares_of_triangles(const TriangleMesh& mesh, const InterestRegion& region,
                                       const VoxelGrid& grid, std::vector<VoxelShare> voxels,
                                       int threads) {
  const auto before = [](const VoxelShare& a, const VoxelShare& b) { return a.voxel < b.voxel; };
  std::sort(voxels.begin(), voxels.end(), before);
  std::vector<float> shares(mesh.triangles.size(), kOutsideRegion);
  parallel_for(shares.size(), threads, [&](std::size_t t) {
    const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
    if (!region.contains(middle)) return;
    shares[t] = kNeverVisible;
    const Vector3d step = 0.5 * grid.resolution() * mesh.normal(t);
    for (int k = -4; k <= 4; ++k) {
      const Vector3d at = middle + k * step;
      if (!grid.contains(at)) continue;
      const VoxelShare wanted{grid.key(at), 0};
      const auto found = std::lower_bound(voxels.begin(), voxels.end(), wanted, before);
      if (found != voxels.end() && found->voxel == wanted.voxel)
        shares[t] = std::max(shares[t], found->share);
    }
  });
  return shares;
}

SurfaceAreas areas_of(const TriangleMesh& mesh, std::span<const float> shares,
                      const InterestRegion& region) {
  SurfaceAreas areas;
  for (std::size_t t = 0; t < shares.size(); ++t) {
    const double area = mesh.area(t);
    if (shares[t] <= kOutsideRegion) {
      const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
      const auto heights = region.heights_at(middle.head<2>());
      if (!heights) continue;
      if (middle.z() > heights->second) areas.above += area;
      if (middle.z() < heights->first) areas.below += area;
      continue;
    }
    areas.known += area;
    if (shares[t] >= 0) areas.visible += area;
    if (shares[t] > 0) areas.seen += area;
  }
  return areas;
}

}  // namespace lapwing
