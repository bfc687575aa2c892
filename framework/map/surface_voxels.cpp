// SPDX-License-Identifier: Apache-2.0
#include "framework/map/surface_voxels.h"

#include <Eigen/Geometry>

#include "framework/core/error.h"

namespace lapwing {
namespace {

// Corners relative to a voxel's lower corner, in voxels: whether the triangle meets [0, 1)^3. By
// separating axes (Akenine-Moeller, 2001): faces of the cube, the triangle's plane, and the
// products of their edges.
class TriangleInGrid {
 public:
  explicit TriangleInGrid(const std::array<Eigen::Vector3d, 3>& corners) : corners_(corners) {
    const Eigen::Vector3d edges[3] = {corners[1] - corners[0], corners[2] - corners[1],
                                      corners[0] - corners[2]};
    add(edges[0].cross(edges[1]));
    for (const Eigen::Vector3d& edge : edges)
      for (int i = 0; i < 3; ++i) add(Eigen::Vector3d::Unit(i).cross(edge));
  }

  bool meets(const Eigen::Vector3d& low) const {
    for (int i = 0; i < 3; ++i) {
      const double a = corners_[0][i], b = corners_[1][i], c = corners_[2][i];
      if (std::min({a, b, c}) >= low[i] + 1 || std::max({a, b, c}) < low[i]) return false;
    }
    for (int k = 0; k < count_; ++k) {
      const Axis& axis = axes_[k];
      const double from = axis.direction.dot(low) + axis.low, to = from + axis.extent;
      if (axis.least > to || axis.most < from) return false;
    }
    return true;
  }

 private:
  struct Axis {
    Eigen::Vector3d direction;
    double least, most;  // of the triangle along it
    double low, extent;  // of a voxel from its lower corner on
  };

  void add(const Eigen::Vector3d& direction) {
    if (direction.squaredNorm() < 1e-24)
      return;  // edges that are parallel, a triangle without area
    Axis& axis = axes_[count_++];
    axis.direction = direction;
    const double a = direction.dot(corners_[0]), b = direction.dot(corners_[1]),
                 c = direction.dot(corners_[2]);
    axis.least = std::min({a, b, c});
    axis.most = std::max({a, b, c});
    axis.low = direction.cwiseMin(0).sum();
    axis.extent = direction.cwiseAbs().sum();
  }

  std::array<Eigen::Vector3d, 3> corners_;
  Axis axes_[10];
  int count_ = 0;
};

class Collector {
 public:
  Collector(double resolution, std::size_t most) : grid_(resolution), most_(most) {}

  void add(const std::array<Eigen::Vector3d, 3>& corners_W, std::size_t number) {
    std::array<Eigen::Vector3d, 3> corners;
    int low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      if (!grid_.contains(corners_W[k]))
        throw InputError("triangle " + std::to_string(number) +
                         " has a corner that is not finite or lies outside a map with voxels of " +
                         std::to_string(grid_.resolution()) + " m");
      corners[k] = corners_W[k] * grid_.per_metre();
    }
    for (int i = 0; i < 3; ++i) {
      low[i] =
          static_cast<int>(std::floor(std::min({corners[0][i], corners[1][i], corners[2][i]})));
      high[i] =
          static_cast<int>(std::floor(std::max({corners[0][i], corners[1][i], corners[2][i]})));
    }
    split(TriangleInGrid(corners), low, high);
  }

  std::vector<VoxelKey> take() {
    tidy();
    return std::move(keys_);
  }

 private:
  void split(const TriangleInGrid& triangle, const int low[3], const int high[3]) {
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) {
          if (!triangle.meets(Eigen::Vector3d(x, y, z))) continue;
          keys_.push_back({static_cast<std::uint16_t>(x + kCenterKey),
                           static_cast<std::uint16_t>(y + kCenterKey),
                           static_cast<std::uint16_t>(z + kCenterKey)});
        }
    if (keys_.size() > 2 * tidied_ + (1u << 20)) tidy();
  }

  // Sorted, each once.
  void tidy() {
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    tidied_ = keys_.size();
    if (tidied_ > most_)
      throw InputError("the surface crosses more than " + std::to_string(most_) + " voxels of " +
                       std::to_string(grid_.resolution()) + " m: take larger ones");
  }

  VoxelGrid grid_;
  std::size_t most_, tidied_ = 0;
  std::vector<VoxelKey> keys_;
};

}  // namespace

std::vector<VoxelKey> surface_voxels(std::span<const Eigen::Vector3d> vertices_W,
                                     std::span<const std::array<std::int32_t, 3>> triangles,
                                     double resolution, std::size_t most) {
  Collector collector(resolution, most);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto vertex = static_cast<std::size_t>(triangles[k][i]);
      if (triangles[k][i] < 0 || vertex >= vertices_W.size())
        throw InputError("triangle " + std::to_string(k) + " names vertex " +
                         std::to_string(triangles[k][i]) + " of " +
                         std::to_string(vertices_W.size()));
      corners[i] = vertices_W[vertex];
    }
    collector.add(corners, k);
  }
  return collector.take();
}

}  // namespace lapwing
