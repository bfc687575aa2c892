// SPDX-License-Identifier: Apache-2.0
// Counts the unmeasured voxels that images saw a surface before, near ones more: what a view from
// another side would see of the far sides of what is known.
//
//   utility: {type: proximity_count, maximum_distance: 4}
#include <algorithm>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/explore/view_rays.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

class ProximityCount final : public ViewUtility {
 public:
  static constexpr PluginText kText{
      "proximity_count", "1.0.0", "unmeasured voxels behind known surfaces, weighted by proximity",
      "Isler et al. 2016; Delmerico et al. 2018, proximity count"};
  static ParameterTable parameters() {
    return ParameterTable()
        .integer("pixel_step", 2, "a ray for every n-th column and row", between(1, 64))
        .number("maximum_distance", 4, "m", "distance behind the surface at which the weight is 0",
                between(0.1, 20));
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kMonotone, nullptr}};
    return all;
  }
  explicit ProximityCount(const Parameters& p)
      : step_(static_cast<int>(p.integer("pixel_step"))), farthest_(p.number("maximum_distance")) {}

  void require_fit(const EpisodeView& known) const override { behind(known).follow(farthest_); }

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    behind(known).require_followed(farthest_);
    parallel_for(views.size(), known.threads,
                 [&](std::size_t i) { values[i] = sum(known, views[i]); });
  }

 private:
  static const HiddenVoxels& behind(const EpisodeView& known) {
    if (!known.hidden)
      throw InputError(
          "utility 'proximity_count' needs the space behind the surfaces that images "
          "saw, and there are no images");
    return *known.hidden;
  }

  double sum(const EpisodeView& known, const Viewpoint& view) const {
    double total = 0;
    HiddenVoxels::Reader hidden(*known.hidden);
    if (!known.map->grid().contains(view.position)) return 0;
    for (const Eigen::Vector3d& direction : view_rays(view, known.pinhole, step_)) {
      RayWalk walk(known.map->grid(), view.position, direction);
      for (; walk.inside() && walk.entered < known.range; walk.advance()) {
        const VoxelReading reading = known.map->read(walk.key());
        if (reading.state == VoxelState::occupied) break;
        if (!reading.known)
          total += std::max(0.0, farthest_ - static_cast<double>(hidden.distance(walk.key())));
      }
    }
    return total;
  }

  int step_;
  double farthest_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::ProximityCount)
