// SPDX-License-Identifier: Apache-2.0
// Rays next to each other from one place, as those of a tile of a view: they go through the same
// free space, and how far all of them are free is found once.
#pragma once

#include "plugins/maps/brick/free_box.h"
#include "plugins/maps/brick/ray_quad.h"

namespace lapwing::brick_map {

class RayBeam {
 public:
  // A tile of 8 x 8 in parts of 4 x 4, these in quads of 2 x 2. Rays that are no tile are only
  // less alike.
  static constexpr int kEdge = 8, kRays = kEdge * kEdge;
  static constexpr int kParts = 4, kQuadsAPart = 4;

  // Where the rays of a quad are among the rays of a tile.
  static constexpr int first_of(int quad) {
    const int part = quad >> 2;
    const int row = (part >> 1) * 4 + (quad >> 1 & 1) * 2, column = (part & 1) * 4 + (quad & 1) * 2;
    return row * kEdge + column;
  }

  // False when the rays do not start in one place, or spread: then nothing else may be called.
  __attribute__((always_inline)) bool take(std::span<const MapRay> rays) {
    origin_ = rays[0].origin;
    range_ = rays[0].range;
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    const std::uint64_t x = bits(origin_.x()), y = bits(origin_.y()), z = bits(origin_.z());
    std::uint64_t apart = 0;
    for (int quad = 0; quad < kRays / 4; ++quad)
      for (int k = 0; k < 4; ++k) {
        const MapRay& ray =
            rays[static_cast<std::size_t>(first_of(quad) + (k >> 1) * kEdge + (k & 1))];
        for (int i = 0; i < 3; ++i) direction_[quad][i][k] = ray.direction[i];
        apart |=
            (bits(ray.origin.x()) ^ x) | (bits(ray.origin.y()) ^ y) | (bits(ray.origin.z()) ^ z);
        range_ = std::min(range_, ray.range);
      }
    if (apart) return false;
    for (int part = 0; part < kParts; ++part)
      for (int i = 0; i < 3; ++i) {
        Four low = direction_[part * kQuadsAPart][i], high = low;
        for (int quad = 1; quad < kQuadsAPart; ++quad) {
          const Four& d = direction_[part * kQuadsAPart + quad][i];
          low = d < low ? d : low;
          high = d > high ? d : high;
        }
        cone_[part].least[i] = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
        cone_[part].most[i] = std::max(std::max(high[0], high[1]), std::max(high[2], high[3]));
      }
    whole_ = cone_[0];
    for (const Cone& cone : cone_)
      for (int i = 0; i < 3; ++i) {
        whole_.least[i] = std::min(whole_.least[i], cone.least[i]);
        whole_.most[i] = std::max(whole_.most[i], cone.most[i]);
      }
    double spread = 0;
    for (int i = 0; i < 3; ++i) spread = std::max(spread, whole_.most[i] - whole_.least[i]);
    return spread < kMostSpread;
  }

  const Eigen::Vector3d& origin() const { return origin_; }
  const Four* directions(int quad) const { return direction_[quad]; }

  // By part, the distance up to which all its rays are free (m).
  std::array<double, kParts> free(const BrickGrid& bricks, const VoxelGrid& grid) const {
    std::array<double, kParts> free;
    const double whole = free_within(bricks, grid, whole_, 0, 16);
    for (int part = 0; part < kParts; ++part)
      free[part] = free_within(bricks, grid, cone_[part], whole, 1);
    return free;
  }

 private:
  // Bounds of directions.
  struct Cone {
    double least[3], most[3];
  };

  // From a distance to which all is free; in steps of at most so many voxels.
  double free_within(const BrickGrid& bricks, const VoxelGrid& grid, const Cone& cone, double from,
                     double longest) const {
    for (double step = longest; step >= 1 && from < range_;) {
      const double to = std::min(from + step * grid.resolution(), range_);
      if (free_between(bricks, grid, cone, from, to))
        from = to;
      else
        step /= 2;
    }
    return from;
  }

  // Whether every voxel that a ray of the cone comes through is free, between two distances.
  bool free_between(const BrickGrid& bricks, const VoxelGrid& grid, const Cone& cone, double from,
                    double to) const {
    int low[3], high[3];
    const double margin = 1e-6 * grid.resolution();  // far more than rounding
    for (int i = 0; i < 3; ++i) {
      const double least = cone.least[i], most = cone.most[i];
      const double a = origin_[i] + least * (least < 0 ? to : from) - margin;
      const double b = origin_[i] + most * (most > 0 ? to : from) + margin;
      if (a < -grid.reach() || b >= grid.reach()) return false;
      low[i] = grid.index(a);
      high[i] = grid.index(b);
    }
    return box_free(bricks, low, high);
  }

  static constexpr double kMostSpread = 0.15;  // of directions; beyond it boxes hold too much else

  Four direction_[kRays / 4][3];
  Cone cone_[kParts], whole_;
  Eigen::Vector3d origin_;
  double range_ = 0;
};

}  // namespace lapwing::brick_map
