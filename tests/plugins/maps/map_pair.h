// SPDX-License-Identifier: Apache-2.0
// Two maps that must be equal.
#pragma once

#include <map>
#include <string>

#include "framework/map/map.h"
#include "framework/plugin/registry.h"

namespace lapwing {

inline const Registry& map_registry() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

inline std::unique_ptr<Map> make_map(const std::string& name, const Value& parameters = {}) {
  return map_registry().create<Map>(name, parameters);
}

// Every known voxel at full resolution, in order.
inline std::vector<VoxelLeaf> voxels_of(const Map& map) {
  std::vector<VoxelLeaf> voxels;
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    const int edge = 1 << leaf.level;
    for (int z = 0; z < edge; ++z)
      for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
          voxels.push_back({{static_cast<std::uint16_t>(leaf.key.x + x),
                             static_cast<std::uint16_t>(leaf.key.y + y),
                             static_cast<std::uint16_t>(leaf.key.z + z)},
                            0,
                            leaf.observations,
                            leaf.log_odds});
  });
  std::sort(voxels.begin(), voxels.end(),
            [](const VoxelLeaf& a, const VoxelLeaf& b) { return a.key < b.key; });
  return voxels;
}

// "" when every known voxel has the same bits, else the first that differs.
inline std::string first_difference(const Map& a, const Map& b) {
  const std::vector<VoxelLeaf> of_a = voxels_of(a), of_b = voxels_of(b);
  for (std::size_t k = 0; k < std::min(of_a.size(), of_b.size()); ++k) {
    if (of_a[k] == of_b[k]) continue;
    const VoxelKey& key = of_a[k].key;
    return "voxel " + std::to_string(key.x) + " " + std::to_string(key.y) + " " +
           std::to_string(key.z) + ": " + std::to_string(of_a[k].log_odds) + " and " +
           std::to_string(of_b[k].log_odds);
  }
  if (of_a.size() == of_b.size()) return "";
  return std::to_string(of_a.size()) + " and " + std::to_string(of_b.size()) + " known voxels";
}

}  // namespace lapwing
