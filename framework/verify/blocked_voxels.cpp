#include "framework/verify/blocked_voxels.h"

#include <cmath>

#include "framework/core/error.h"

namespace lapwing {

BlockedVoxels::BlockedVoxels(const MapFile& file, const Eigen::AlignedBox3d& box)
    : grid_(file.resolution) {
  if (file.two_states)
    throw InputError("a map of two states (.bt) cannot say what it does not know; write an .ot");
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

}  // namespace lapwing
