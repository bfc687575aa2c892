// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/episode_map.h"

namespace lapwing {

VoxelBox clear_box(Map& map, const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d inside = Eigen::Vector3d::Constant(map.grid().resolution() / 2);
  const VoxelKey low = map.grid().key(box.min() + inside),
                 high = map.grid().key(box.max() - inside);
  std::vector<VoxelLeaf> leaves;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        leaves.push_back({{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                           static_cast<std::uint16_t>(z)},
                          0,
                          0,
                          map.settings().clamp_min});
  map.import(leaves);
  return {low, high};
}

std::optional<VoxelBox> clear_body(Map& map, const Viewpoint& view, double body) {
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(body / 2);
  if (map.swept_box_free(view.position, view.position, half)) return std::nullopt;
  return clear_box(map, cleared_box(map.grid(), view.position, body));
}

}  // namespace lapwing
