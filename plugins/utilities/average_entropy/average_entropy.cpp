// SPDX-License-Identifier: Apache-2.0
// The mean entropy of the voxels on the way to surfaces that are already known.
//
//   utility: {type: average_entropy, pixel_step: 2}
#include <cmath>

#include "framework/explore/ray_utility.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

// Bits; 1 where nothing is known. Along a ray most voxels say what the one before did: its
// logarithms are kept.
class Entropy {
 public:
  double of(const VoxelReading& reading) {
    if (!reading.known) return 1;
    if (reading.log_odds != log_odds_) {
      log_odds_ = reading.log_odds;
      const double p = probability_of(log_odds_);
      bits_ = -p * std::log2(p) - (1 - p) * std::log2(1 - p);
    }
    return bits_;
  }

 private:
  decltype(VoxelReading::log_odds) log_odds_ = 0;
  double bits_ = 1;
};

class AverageEntropy final : public RayUtility {
 public:
  static constexpr PluginText kText{"average_entropy", "1.0.0",
                                    "mean entropy of the voxels in front of known surfaces",
                                    "Isler et al. 2016; Delmerico et al. 2018, average entropy"};
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kMonotone, nullptr}};
    return all;
  }
  explicit AverageEntropy(const Parameters& parameters) : RayUtility(parameters) {}

 protected:
  double value_of(const EpisodeView& known, const Viewpoint& view) const override {
    double entropy = 0, met = 0;
    Entropy bits;
    for (const Eigen::Vector3d& direction : rays_of(known, view)) {
      double on_ray = 0, voxels = 0;
      bool ends = false;
      walk_ray(*known.map, view.position, direction, known.range,
               [&](const VoxelReading& reading, double) {
                 on_ray += bits.of(reading);
                 voxels += 1;
                 ends = reading.state == VoxelState::occupied;
                 return !ends;
               });
      if (!ends) continue;
      entropy += on_ray;
      met += voxels;
    }
    return met > 0 ? entropy / met : 0;
  }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::AverageEntropy)
