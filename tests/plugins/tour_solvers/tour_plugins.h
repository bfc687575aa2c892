// SPDX-License-Identifier: Apache-2.0
// The tour solvers of the build tree.
#pragma once

#include "framework/plugin/registry.h"
#include "framework/view/tour_solver.h"

namespace lapwing {

inline const Registry& tour_plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

}  // namespace lapwing
