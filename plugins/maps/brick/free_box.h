// SPDX-License-Identifier: Apache-2.0
// Whether boxes of voxels are free throughout, word by word.
#pragma once

#include <array>

#include "plugins/maps/brick/brick_grid.h"

namespace lapwing::brick_map {

// The parts of a 4^3 from `low` to `high`, both included, each 0 to 3 along each axis.
constexpr std::array<std::array<std::array<std::uint64_t, 4>, 4>, 3> part_spans() {
  std::array<std::array<std::array<std::uint64_t, 4>, 4>, 3> spans{};
  for (int axis = 0; axis < 3; ++axis)
    for (int low = 0; low < 4; ++low)
      for (int high = low; high < 4; ++high)
        for (int part = 0; part < 64; ++part) {
          const int at = part >> 2 * axis & 3;
          if (at >= low && at <= high) spans[axis][low][high] |= std::uint64_t{1} << part;
        }
  return spans;
}
inline constexpr auto kPartSpans = part_spans();

// Of an aligned cube whose 4^3 parts have (2^shift)^3 voxels: those that the box from `low` to
// `high` (voxels, both included) meets; it must meet one.
inline std::uint64_t parts_within(const int corner[3], int shift, const int low[3],
                                  const int high[3]) {
  std::uint64_t parts = kAll;
  for (int i = 0; i < 3; ++i)
    parts &= kPartSpans[i][std::max(0, (low[i] - corner[i]) >> shift)]
                       [std::min(3, (high[i] - corner[i]) >> shift)];
  return parts;
}

// Voxels from `low` to `high`, both included, inside the largest map.
inline bool box_free(const BrickGrid& bricks, const int low[3], const int high[3]) {
  for (int z = low[2] & ~63; z <= high[2]; z += 64)
    for (int y = low[1] & ~63; y <= high[1]; y += 64)
      for (int x = low[0] & ~63; x <= high[0]; x += 64) {
        const int corner[3] = {x, y, z};
        const Block* block = bricks.find(corner);
        if (!block) return false;
        std::uint64_t in_block = parts_within(corner, kBrickLevel, low, high) & ~block->all_free;
        for (; in_block; in_block &= in_block - 1) {
          const int at = std::countr_zero(in_block);
          if (!block->has_brick(at)) return false;
          const DenseBrick& brick = *block->content[at].brick;
          const int brick_corner[3] = {x + ((at & 3) << 4), y + ((at >> 2 & 3) << 4),
                                       z + ((at >> 4) << 4)};
          std::uint64_t in_brick =
              parts_within(brick_corner, kChunkLevel, low, high) & ~brick.all_free;
          for (; in_brick; in_brick &= in_brick - 1) {
            const int chunk = std::countr_zero(in_brick);
            const int chunk_corner[3] = {brick_corner[0] + ((chunk & 3) << 2),
                                         brick_corner[1] + ((chunk >> 2 & 3) << 2),
                                         brick_corner[2] + ((chunk >> 4) << 2)};
            if (parts_within(chunk_corner, 0, low, high) & ~brick.free[chunk]) return false;
          }
        }
      }
  return true;
}

}  // namespace lapwing::brick_map
