// SPDX-License-Identifier: Apache-2.0
// Close, square views tell most (thesis 4.7; reading 4.3).
//
//   vi   = 1/xi  vi_i  vi_r
//   vi_i = exp(-max(gamma - T_i, 0) / F_i)     gamma: angle between the ray and the normal
//   vi_r = exp(-max(T_r - px, 0) / F_r)        px: pixels that the voxel's edge takes
//
// Back faces tell nothing, and so does what lies beyond the distance up to which depth will be used
// for the model, where one is given; where the normal is not known a constant takes the place of
// vi_i.
//
//   information: fronto_parallel
#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/view/view_information.h"

namespace lapwing {
namespace {

class FrontoParallel final : public ViewInformation {
 public:
  static constexpr PluginText kText{
      "fronto_parallel", "1.0.0",
      "more information from close views at right angles to the surface", "thesis 4.4.4, (4.7)"};
  static ParameterTable parameters() {
    return ParameterTable()
        .number("views", 3, "", "number of perfect views for full information about a voxel, xi",
                at_least(1))
        .number("incidence_deg", 25, "deg", "largest angle of incidence without loss",
                between(0, 90))
        .number("incidence_falloff_deg", 25, "deg",
                "additional angle that reduces the information by a factor e", above(0))
        .number("pixels", 6, "px", "size of a voxel in the image without loss", at_least(0))
        .number("pixels_falloff", 3, "px",
                "missing pixels that reduce the information by a factor e", above(0))
        .number("unknown_normal", 0.2, "", "factor for a voxel with unknown normal", between(0, 1))
        .optional_number("farthest", "m", "distance beyond which the information is 0", above(0));
  }
  explicit FrontoParallel(const Parameters& p)
      : views_(p.number("views")),
        incidence_(radians(p.number("incidence_deg"))),
        incidence_falloff_(radians(p.number("incidence_falloff_deg"))),
        pixels_(p.number("pixels")),
        pixels_falloff_(p.number("pixels_falloff")),
        unknown_normal_(p.number("unknown_normal")),
        farthest_(p.has("farthest") ? p.number("farthest")
                                    : std::numeric_limits<double>::infinity()) {}

  void contributions(std::span<const VoxelSight> sights, std::span<float> values) const override {
    for (std::size_t k = 0; k < sights.size(); ++k)
      values[k] = static_cast<float>(square(sights[k]) * close(sights[k]) / views_);
  }

 private:
  double square(const VoxelSight& sight) const {
    if (sight.distance > farthest_) return 0;
    if (!sight.incidence) return unknown_normal_;
    if (*sight.incidence >= radians(90)) return 0;
    return std::exp(-std::max(*sight.incidence - incidence_, 0.0) / incidence_falloff_);
  }
  double close(const VoxelSight& sight) const {
    return std::exp(-std::max(pixels_ - sight.pixels, 0.0) / pixels_falloff_);
  }

  double views_, incidence_, incidence_falloff_, pixels_, pixels_falloff_, unknown_normal_;
  double farthest_;  // m
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::FrontoParallel)
