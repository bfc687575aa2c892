// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/path_clearance.h"

#include <algorithm>
#include <cmath>

namespace lapwing {

double largest_acceleration(const Vehicle& vehicle) {
  return std::hypot(vehicle.acceleration_across_max, std::max(vehicle.largest_acceleration_up(),
                                                              vehicle.largest_acceleration_down()));
}

}  // namespace lapwing
