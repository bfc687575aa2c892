// SPDX-License-Identifier: Apache-2.0
// A map to test what needs only a map's reads.
#pragma once

#include "framework/core/error.h"
#include "framework/map/plain_map.h"

namespace lapwing {

inline MapSettings settings_with(double resolution) {
  Value value = Value::map();
  value.set("resolution", resolution);
  return map_settings(check(map_parameters(), value));
}

class SmallMap final : public PlainMap {
 public:
  explicit SmallMap(double resolution = 0.5) : PlainMap(settings_with(resolution)) {}
};

}  // namespace lapwing
