// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/blocked_voxels.h"

#include <cmath>

#include "framework/core/error.h"

namespace lapwing {

BlockedVoxels::BlockedVoxels(const MapFile& file, const Eigen::AlignedBox3d& box)
    : grid_(file.resolution) {
  if (file.two_states)
    throw InputError(
        "a map with two states (.bt) does not distinguish unknown voxels; write an .ot file");
  constexpr double kFreeBelow = 0.25;  // map/map.h
  const float free_below = log_odds_of(kFreeBelow);
  double voxels = 1;
  for (int i = 0; i < 3; ++i) {
    const double reach = grid_.reach();
    low_[i] = std::clamp(grid_.index(std::clamp(box.min()(i), -reach, reach)), 0, kKeyCount - 1);
    const int high =
        std::clamp(grid_.index(std::clamp(box.max()(i), -reach, reach)), 0, kKeyCount - 1);
    size_[i] = high - low_[i] + 1;
    voxels *= size_[i];
  }
  if (voxels > 2147483648.0)
    throw InputError("the flight passes through a box of more than 2^31 voxels of the map");
  free_.assign(static_cast<std::size_t>(voxels) / 64 + 1, 0);
  for (const VoxelLeaf& leaf : file.leaves) {
    if (!(leaf.log_odds < free_below)) continue;
    int from[3], to[3];
    for (int i = 0; i < 3; ++i) {
      from[i] = std::max(static_cast<int>(leaf.key[i]) - low_[i], 0);
      to[i] = std::min(static_cast<int>(leaf.key[i]) + (1 << leaf.level) - low_[i], size_[i]);
    }
    for (int z = from[2]; z < to[2]; ++z)
      for (int y = from[1]; y < to[1]; ++y)
        for (int x = from[0]; x < to[0]; ++x) {
          const std::size_t bit =
              (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) +
               static_cast<std::size_t>(y)) *
                  static_cast<std::size_t>(size_[0]) +
              static_cast<std::size_t>(x);
          free_[bit / 64] |= std::uint64_t{1} << (bit % 64);
        }
  }
}

double BlockedVoxels::distance(const Eigen::Vector3d& p_W, double farthest) const {
  int at[3];
  for (int i = 0; i < 3; ++i) {
    const double low = grid_.face(low_[i]), high = grid_.face(low_[i] + size_[i]);
    if (!(p_W(i) >= low && p_W(i) < high)) return 0;
    at[i] = grid_.index(p_W(i)) - low_[i];
  }
  if (!free(at[0], at[1], at[2])) return 0;
  // Shell after shell of voxels about the one that holds p. A voxel of the shell `ring` is at least
  // (ring - 1) voxels away.
  double nearest2 = farthest * farthest;
  const auto gap = [&](int axis, int index) {
    const double low = grid_.face(low_[axis] + index), high = grid_.face(low_[axis] + index + 1);
    return std::max({0.0, low - p_W(axis), p_W(axis) - high});
  };
  for (int ring = 1; (ring - 1) * grid_.resolution() < std::sqrt(nearest2); ++ring) {
    for (int z = -ring; z <= ring; ++z) {
      const double dz = gap(2, at[2] + z);
      if (dz * dz >= nearest2) continue;
      for (int y = -ring; y <= ring; ++y) {
        const double dy = gap(1, at[1] + y), across = dz * dz + dy * dy;
        if (across >= nearest2) continue;
        const bool face = std::abs(z) == ring || std::abs(y) == ring;
        for (int x = -ring; x <= ring; x += face ? 1 : 2 * ring) {
          if (free(at[0] + x, at[1] + y, at[2] + z)) continue;
          const double dx = gap(0, at[0] + x);
          nearest2 = std::min(nearest2, across + dx * dx);
        }
      }
    }
  }
  return std::sqrt(nearest2);
}

namespace {

// Where from + s (to - from), s from 0 to 1, is nearest to a box: s. The squared distance is convex
// and changes its form only where the way crosses the plane of a side.
double nearest_share(const Eigen::Vector3d& from, const Eigen::Vector3d& way,
                     const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  // Half the slope of the squared distance at s.
  const auto slope = [&](double s) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double p = from(i) + s * way(i);
      sum += (p - std::clamp(p, low(i), high(i))) * way(i);
    }
    return sum;
  };
  if (slope(0) >= 0) return 0;
  if (slope(1) <= 0) return 1;
  double below = 0, above = 1;  // the slope is below 0, and not
  for (int i = 0; i < 3; ++i) {
    if (way(i) == 0) continue;
    for (const double side : {low(i), high(i)}) {
      const double s = (side - from(i)) / way(i);
      if (s > below && s < above) (slope(s) < 0 ? below : above) = s;
    }
  }
  // In between it rises on a straight line.
  const double at_below = slope(below), at_above = slope(above);
  return at_above > at_below ? below - at_below * (above - below) / (at_above - at_below) : below;
}

}  // namespace

BlockedVoxels::Nearest BlockedVoxels::nearest(const Eigen::Vector3d& from,
                                              const Eigen::Vector3d& to, double farthest) const {
  Nearest best{farthest, 0};
  // Piece by piece, so that the boxes about them stay small.
  constexpr double kPiece = 8;  // voxels
  const Eigen::Vector3d way = to - from;
  const int pieces =
      std::max(1, static_cast<int>(std::ceil(way.norm() / (kPiece * grid_.resolution()))));
  for (int piece = 0; piece < pieces && best.distance > 0; ++piece) {
    const double first = static_cast<double>(piece) / pieces;
    const Eigen::Vector3d a = from + first * way, step = way / pieces, b = a + step;
    int low[3], high[3];
    for (int i = 0; i < 3; ++i) {
      // One more on either side: everything beyond what is held is blocked.
      const auto index = [&](double x) {
        const double reach = grid_.reach();
        return std::clamp(grid_.index(std::clamp(x, -reach, reach)) - low_[i], -1, size_[i]);
      };
      low[i] = index(std::min(a(i), b(i)) - best.distance);
      high[i] = index(std::max(a(i), b(i)) + best.distance);
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) {
          if (free(x, y, z)) continue;
          const int at[3] = {x, y, z};
          Eigen::Vector3d lower, upper;
          for (int i = 0; i < 3; ++i) {
            // What is beyond reaches as far as one likes.
            constexpr double kFar = 1e9;
            lower(i) = at[i] < 0 ? -kFar : grid_.face(low_[i] + at[i]);
            upper(i) = at[i] >= size_[i] ? kFar : grid_.face(low_[i] + at[i] + 1);
          }
          const double share = nearest_share(a, step, lower, upper);
          const Eigen::Vector3d p = a + share * step;
          const double distance = (lower - p).cwiseMax(p - upper).cwiseMax(0.0).norm();
          if (distance < best.distance) best = {distance, first + share / pieces};
        }
  }
  return best;
}

}  // namespace lapwing
