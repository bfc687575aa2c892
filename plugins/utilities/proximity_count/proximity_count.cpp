// Counts unmeasured voxels behind surfaces that a view would see, near ones more.
//
//   utility: {type: proximity_count, maximum_distance: 4}
#include "framework/core/parallel.h"
#include "framework/explore/view_rays.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

class ProximityCount final : public ViewUtility {
 public:
  static constexpr PluginText kText{"proximity_count", "1.0.0",
                                    "counts unmeasured voxels behind seen surfaces, near ones more",
                                    "Isler et al. 2016; Delmerico et al. 2018, proximity count"};
  static ParameterTable parameters() {
    return ParameterTable()
        .integer("pixel_step", 2, "a ray through every so many pixels and rows", between(1, 64))
        .number("maximum_distance", 4, "m", "behind the surface, where voxels no longer count",
                between(0.1, 100));
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kMonotone, nullptr}};
    return all;
  }
  explicit ProximityCount(const Parameters& p)
      : step_(static_cast<int>(p.integer("pixel_step"))), farthest_(p.number("maximum_distance")) {}

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    parallel_for(views.size(), known.threads,
                 [&](std::size_t i) { values[i] = sum(known, views[i]); });
  }

 private:
  double sum(const EpisodeView& known, const Viewpoint& view) const {
    double total = 0;
    for (const Eigen::Vector3d& direction : view_rays(view, known.pinhole, step_)) {
      double surface = -1;  // m, where the ray enters the surface that it meets first
      walk_ray(*known.map, view.position, direction, known.range + farthest_,
               [&](const VoxelReading& reading, double distance) {
                 if (surface < 0) {
                   if (reading.state == VoxelState::occupied) surface = distance;
                   return distance < known.range;
                 }
                 if (distance - surface >= farthest_) return false;
                 if (!reading.known) total += farthest_ - (distance - surface);
                 return true;
               });
    }
    return total;
  }

  int step_;
  double farthest_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::ProximityCount)
