// SPDX-License-Identifier: Apache-2.0
// States of the learned utility's network, for its tests.
#pragma once

#include "framework/core/random.h"
#include "plugins/utilities/learned/network.h"

namespace lapwing::learned {

// Scales, shifts and running statistics that are not what they begin with.
inline void scatter_normalisations(const NetworkLayout& layout, NetworkState& state,
                                   Random& random) {
  for (const UnitPlace& unit : layout.units)
    for (int c = 0; c < unit.out; ++c) {
      const auto k = static_cast<std::size_t>(c);
      state.parameters[unit.scale + k] = static_cast<float>(random.uniform(0.5, 1.5));
      state.parameters[unit.shift + k] = static_cast<float>(random.uniform(-0.3, 0.3));
      state.statistics[unit.mean + k] = static_cast<float>(random.uniform(-0.5, 0.5));
      state.statistics[unit.variance + k] = static_cast<float>(random.uniform(0.5, 2));
    }
}

}  // namespace lapwing::learned
