// SPDX-License-Identifier: Apache-2.0
// Flying plans and timing paths: methods of `run`.
#pragma once

#include "framework/mission/binding.h"
#include "framework/trajectory/polyline.h"

namespace lapwing {

// x, y, z of two points or more in turn. InputError naming the key.
Points points_of(const Parameters& given, const std::string& key);

// fly, time_path, path_distance, pursue.
std::span<const Binding> flight_methods_of_run();

}  // namespace lapwing
