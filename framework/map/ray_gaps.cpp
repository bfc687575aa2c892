// SPDX-License-Identifier: Apache-2.0
// How: at a depth d along the optical axis, the rays of four neighbouring pixels form a square of
// edge d / f. Its diagonal sqrt(2) d / f is the gap. `gap_at` takes the smallest gap of the images
// that see the place. The ray to the camera is cast only for images that would reduce it.
//
// widest_gaps evaluates a lattice, one layer per task, and then takes the maximum over each place
// and its 26 neighbours. Between two places of the lattice may lie the edge of an image's frame or
// of what it sees, and then the wider gap is the right one.
#include "framework/map/ray_gaps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/parallel.h"

namespace lapwing {
namespace {

// Depth of a place in an image, m; 0 where the image does not have it.
double depth_in(const MeasuringImage& image, const Eigen::Vector3d& place) {
  const Eigen::Vector3d seen =
      image.camera.orientation.conjugate() * (place - image.camera.position);
  if (seen.z() <= 0 || seen.z() > image.range) return 0;
  const Pinhole& pinhole = image.pinhole;
  const double x = pinhole.focal_x * seen.x() / seen.z() + pinhole.principal_x;
  const double y = pinhole.focal_y * seen.y() / seen.z() + pinhole.principal_y;
  const bool inside =
      x >= -0.5 && x <= pinhole.width - 0.5 && y >= -0.5 && y <= pinhole.height - 0.5;
  return inside ? seen.z() : 0;
}

}  // namespace

double gap_between_rays(const Pinhole& pinhole, double depth) {
  return std::numbers::sqrt2 * depth / std::min(pinhole.focal_x, pinhole.focal_y);
}

double gap_at(const Eigen::Vector3d& place, const MapRays& rays, const MeshScene* mesh) {
  double seen = 0, framed = 0;  // 0: none yet
  for (const MeasuringImage& image : rays.images) {
    const double depth = depth_in(image, place);
    if (depth == 0) continue;
    const double gap = gap_between_rays(image.pinhole, depth);
    if (framed == 0 || gap < framed) framed = gap;
    if (seen > 0 && gap >= seen) continue;
    const Eigen::Vector3d way = place - image.camera.position;
    const double length = way.norm();
    if (mesh && mesh->blocked({image.camera.position, way / length, length})) continue;
    seen = gap;
  }
  return seen > 0 ? seen : framed > 0 ? framed : rays.elsewhere;
}

std::vector<double> widest_gaps(const PlaceLattice& lattice, const MapRays& rays,
                                const MeshScene* mesh, int threads) {
  const auto [count_x, count_y, count_z] = lattice.size;
  std::vector<double> gaps(lattice.place(0, 0, count_z));
  parallel_for(static_cast<std::size_t>(count_z), threads, [&](std::size_t layer) {
    const int z = static_cast<int>(layer);
    for (int y = 0; y < lattice.size[1]; ++y)
      for (int x = 0; x < lattice.size[0]; ++x)
        gaps[lattice.place(x, y, z)] =
            gap_at(lattice.first + lattice.spacing * Eigen::Vector3d(x, y, z), rays, mesh);
  });
  std::vector<double> widest = gaps;
  for (int z = 0; z < count_z; ++z)
    for (int y = 0; y < count_y; ++y)
      for (int x = 0; x < count_x; ++x)
        for (int c = std::max(z - 1, 0); c < std::min(z + 2, count_z); ++c)
          for (int b = std::max(y - 1, 0); b < std::min(y + 2, count_y); ++b)
            for (int a = std::max(x - 1, 0); a < std::min(x + 2, count_x); ++a) {
              double& here = widest[lattice.place(x, y, z)];
              here = std::max(here, gaps[lattice.place(a, b, c)]);
            }
  return widest;
}

}  // namespace lapwing
