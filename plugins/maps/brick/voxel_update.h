// SPDX-License-Identifier: Apache-2.0
// What one scan does to the 64 voxels of a chunk.
#pragma once

#include <cstdint>

#include "framework/map/map_settings.h"

namespace lapwing::brick_map {

// Adds the hit to voxels of `hit`, the miss to the other `measured` ones, and clamps after the
// addition, in single precision. Returns which of the measured voxels are free now.
std::uint64_t update_voxels(float values[64], std::uint64_t measured, std::uint64_t hit,
                            const MapSettings& settings);

}  // namespace lapwing::brick_map
