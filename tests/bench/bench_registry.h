// SPDX-License-Identifier: Apache-2.0
// The plugins of the build tree.
#pragma once

#include "framework/plugin/registry.h"

namespace lapwing {

inline const Registry& bench_registry() {
  static const Registry instance(plugin_search_path({}));
  return instance;
}

}  // namespace lapwing
