// SPDX-License-Identifier: Apache-2.0
// What a scan measured in one brick.
#pragma once

#include <cstdint>

#include "plugins/maps/brick/brick_grid.h"

namespace lapwing::brick_map {

// Measured voxels and those among them that hold a point, by chunk.
struct BrickMarks {
  int cell[3] = {};          // its lowest voxel
  std::uint64_t chunks = 0;  // with a mark
  std::uint64_t measured[64] = {}, hit[64] = {};
};

}  // namespace lapwing::brick_map
