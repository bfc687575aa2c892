// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/ray_utility.h"

#include "framework/core/parallel.h"

namespace lapwing {

ParameterTable RayUtility::parameters() {
  return ParameterTable().integer("pixel_step", 2, "a ray for every n-th column and row",
                                  between(1, 64));
}

RayUtility::RayUtility(const Parameters& parameters)
    : pixel_step_(static_cast<int>(parameters.integer("pixel_step"))) {}

void RayUtility::values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                           std::span<double> values) const {
  parallel_for(views.size(), known.threads,
               [&](std::size_t i) { values[i] = value_of(known, views[i]); });
}

}  // namespace lapwing
