// SPDX-License-Identifier: Apache-2.0
// Methods of `run` that place a mission on the earth: its origin and its take-off place.
#pragma once

#include <span>

#include "framework/mission/binding.h"

namespace lapwing {

std::span<const Binding> place_methods_of_run();  // take_origin, take_home

}  // namespace lapwing
