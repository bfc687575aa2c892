// Counts the unknown voxels that a view would see first: the border of what is known.
//
//   utility: {type: frontier, pixel_step: 2}
#include <algorithm>

#include "framework/core/parallel.h"
#include "framework/explore/view_rays.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

class Frontier final : public ViewUtility {
 public:
  static constexpr PluginText kText{"frontier", "1.0.0",
                                    "number of visible unknown voxels at the border of free space",
                                    "thesis 5.5.2; Yamauchi 1997"};
  static ParameterTable parameters() {
    return ParameterTable().integer("pixel_step", 2, "one ray per so many columns and rows",
                                    between(1, 64));
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kMonotone, nullptr}};
    return all;
  }
  explicit Frontier(const Parameters& p) : step_(static_cast<int>(p.integer("pixel_step"))) {}

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    parallel_for(views.size(), known.threads,
                 [&](std::size_t i) { values[i] = count(known, views[i]); });
  }

 private:
  double count(const EpisodeView& known, const Viewpoint& view) const {
    std::vector<MapRay> rays;
    for (const Eigen::Vector3d& direction : view_rays(view, known.pinhole, step_))
      rays.push_back({view.position, direction, known.range});
    std::vector<MapRayHit> hits(rays.size());
    known.map->cast(rays, hits);
    std::vector<std::uint64_t> unknown;
    for (const MapRayHit& hit : hits)
      if (hit.state == VoxelState::unknown) unknown.push_back(hit.voxel.morton());
    std::sort(unknown.begin(), unknown.end());
    return static_cast<double>(std::unique(unknown.begin(), unknown.end()) - unknown.begin());
  }

  int step_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Frontier)
