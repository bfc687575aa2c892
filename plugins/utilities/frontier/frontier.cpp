// SPDX-License-Identifier: Apache-2.0
// Counts the unknown voxels that a view would see first: the border of what is known.
//
//   utility: {type: frontier, pixel_step: 2}
#include <algorithm>

#include "framework/explore/ray_utility.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

class Frontier final : public RayUtility {
 public:
  static constexpr PluginText kText{"frontier", "1.0.0",
                                    "number of visible unknown voxels at the border of free space",
                                    "thesis 5.5.2; Yamauchi 1997"};
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kMonotone, nullptr}};
    return all;
  }
  explicit Frontier(const Parameters& parameters) : RayUtility(parameters) {}

 protected:
  double value_of(const EpisodeView& known, const Viewpoint& view) const override {
    std::vector<MapRay> rays;
    for (const Eigen::Vector3d& direction : rays_of(known, view))
      rays.push_back({view.position, direction, known.range});
    std::vector<MapRayHit> hits(rays.size());
    known.map->cast(rays, hits);
    std::vector<std::uint64_t> unknown;
    for (const MapRayHit& hit : hits)
      if (hit.state == VoxelState::unknown) unknown.push_back(hit.voxel.morton());
    std::sort(unknown.begin(), unknown.end());
    return static_cast<double>(std::unique(unknown.begin(), unknown.end()) - unknown.begin());
  }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Frontier)
