#include "framework/map/known_surface.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "framework/core/error.h"
#include "framework/core/parallel.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kMostVoxels = 268435456.0;  // 2^28
constexpr int kCube = 8;    // voxels along an edge, whose faces are added as vectors
constexpr int kFewest = 8;  // faces; fewer in a cube are specks

enum class Seen : std::uint8_t { never, air, surface };

// What was measured of the voxels whose middles lie in a region, and of a rim of one voxel.
class Measured {
 public:
  Measured(const Map& map, const MeshScene* mesh, const Eigen::AlignedBox3d& region, int threads)
      : grid_(map.grid()), mesh_(mesh) {
    double count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double reach = grid_.reach() - 2 * grid_.resolution();
      const double lowest = std::clamp(region.min()[axis], -reach, reach);
      const double highest = std::clamp(region.max()[axis], -reach, reach);
      low_[i] = grid_.index(lowest) + (grid_.center(grid_.index(lowest)) < lowest ? 1 : 0) - 1;
      const int high =
          grid_.index(highest) - (grid_.center(grid_.index(highest)) > highest ? 1 : 0) + 1;
      size_[i] = std::max(2, high - low_[i] + 1);
      count *= size_[i];
    }
    if (count > kMostVoxels)
      throw InputError("the region of interest holds more than 2^28 voxels; take larger ones");
    voxels_.resize(static_cast<std::size_t>(count));
    parallel_for(static_cast<std::size_t>(size_[2]), threads, [&](std::size_t z) {
      for (int y = 0; y < size_[1]; ++y)
        for (int x = 0; x < size_[0]; ++x) {
          const VoxelReading voxel = map.read(key(x, y, static_cast<int>(z)));
          voxels_[place(x, y, static_cast<int>(z))] = !voxel.known         ? Seen::never
                                                      : voxel.log_odds > 0 ? Seen::surface
                                                                           : Seen::air;
        }
    });
  }

  int size(int axis) const { return size_[static_cast<std::size_t>(axis)]; }
  Seen at(int x, int y, int z) const { return voxels_[place(x, y, z)]; }
  // Whether a voxel that was never measured is more than a gap in a surface. Not of the rim.
  bool hides(int x, int y, int z) const {
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (at(x + dx, y + dy, z + dz) == Seen::surface) return false;
    return !mesh_ || !mesh_->nearest(grid_.center(key(x, y, z)), 1.5 * grid_.resolution());
  }

 private:
  VoxelKey key(int x, int y, int z) const {
    return {static_cast<std::uint16_t>(low_[0] + x), static_cast<std::uint16_t>(low_[1] + y),
            static_cast<std::uint16_t>(low_[2] + z)};
  }
  std::size_t place(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(x);
  }

  VoxelGrid grid_;
  const MeshScene* mesh_;
  std::array<int, 3> low_{}, size_{};
  std::vector<Seen> voxels_;
};

// Area of the faces between air and what hides in the cube that begins at `low`, in faces of
// voxels. What looks up an axis and what looks down it are two surfaces as far as both are there.
double edge_of_cube(const Measured& measured, const std::array<int, 3>& low) {
  const auto inside = [&](int axis, int at) { return at >= 1 && at < measured.size(axis) - 1; };
  Eigen::Array3i up = Eigen::Array3i::Zero(), down = Eigen::Array3i::Zero();
  for (int z = low[2]; z < low[2] + kCube && inside(2, z); ++z)
    for (int y = low[1]; y < low[1] + kCube && inside(1, y); ++y)
      for (int x = low[0]; x < low[0] + kCube && inside(0, x); ++x) {
        if (measured.at(x, y, z) != Seen::never) continue;
        Eigen::Array3i above = Eigen::Array3i::Zero(), below = Eigen::Array3i::Zero();
        for (int axis = 0; axis < 3; ++axis)
          for (const int side : {-1, 1}) {
            const Eigen::Vector3i n = Eigen::Vector3i(x, y, z) + side * Eigen::Vector3i::Unit(axis);
            if (inside(axis, n[axis]) && measured.at(n.x(), n.y(), n.z()) == Seen::air)
              ++(side > 0 ? above : below)[axis];
          }
        if (above.sum() + below.sum() == 0 || !measured.hides(x, y, z)) continue;
        up += above;
        down += below;
      }
  if (up.sum() + down.sum() < kFewest) return 0;
  return up.max(down).cast<double>().matrix().norm() + up.min(down).cast<double>().matrix().norm();
}

}  // namespace

std::vector<float> shares_of_triangles(const TriangleMesh& mesh, const Eigen::AlignedBox3d& region,
                                       const VoxelGrid& grid, std::vector<VoxelShare> voxels) {
  const auto before = [](const VoxelShare& a, const VoxelShare& b) { return a.voxel < b.voxel; };
  std::sort(voxels.begin(), voxels.end(), before);
  std::vector<float> shares(mesh.triangles.size(), kOutsideRegion);
  for (std::size_t t = 0; t < shares.size(); ++t) {
    const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
    if (!region.contains(middle)) continue;
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
  }
  return shares;
}

SurfaceAreas areas_of(const TriangleMesh& mesh, std::span<const float> shares,
                      const Eigen::AlignedBox3d& region) {
  SurfaceAreas areas;
  for (std::size_t t = 0; t < shares.size(); ++t) {
    const double area = mesh.area(t);
    if (shares[t] <= kOutsideRegion) {
      const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
      const Vector3d beside(middle.x(), middle.y(), region.center().z());
      if (region.contains(beside))
        (middle.z() > region.max().z() ? areas.above : areas.below) += area;
      continue;
    }
    areas.known += area;
    if (shares[t] >= 0) areas.visible += area;
    if (shares[t] > 0) areas.seen += area;
  }
  return areas;
}

double unknown_edge(const Map& map, const MeshScene* mesh, const Eigen::AlignedBox3d& region,
                    int threads) {
  const Measured measured(map, mesh, region, threads);
  std::vector<std::array<int, 3>> cubes;
  for (int z = 1; z < measured.size(2) - 1; z += kCube)
    for (int y = 1; y < measured.size(1) - 1; y += kCube)
      for (int x = 1; x < measured.size(0) - 1; x += kCube) cubes.push_back({x, y, z});
  std::vector<double> edges(cubes.size(), 0);
  parallel_for(cubes.size(), threads,
               [&](std::size_t k) { edges[k] = edge_of_cube(measured, cubes[k]); });
  const double face = map.grid().resolution() * map.grid().resolution();
  return face * std::accumulate(edges.begin(), edges.end(), 0.0);
}

}  // namespace lapwing
