// SPDX-License-Identifier: Apache-2.0
// Occupancy files: whatever the bytes, a map or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/map/map_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const lapwing::MapFile file =
        lapwing::parse_map({reinterpret_cast<const char*>(data), size}, "input");
    // What is read is sound: finite places in order, every leaf a whole cube.
    if (!(file.resolution > 0)) std::abort();
    for (const lapwing::VoxelLeaf& leaf : file.leaves) {
      const int low = (1 << leaf.level) - 1;
      if (leaf.level > lapwing::kTreeDepth) std::abort();
      if ((leaf.key.x & low) || (leaf.key.y & low) || (leaf.key.z & low)) std::abort();
      if (leaf.log_odds != leaf.log_odds) std::abort();
    }
  } catch (const lapwing::InputError&) {
  }
  return 0;
}
