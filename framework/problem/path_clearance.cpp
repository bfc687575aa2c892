#include "framework/problem/path_clearance.h"

#include <algorithm>
#include <cmath>

#include "framework/core/units.h"

namespace lapwing {

// Rotors push and never pull: falling is the fastest way down.
double largest_acceleration(const Vehicle& vehicle) {
  const double thrust = vehicle.thrust_max() / vehicle.mass - kGravity;
  const double up = std::min(vehicle.acceleration_up_max.value_or(thrust), thrust);
  const double down = std::min(vehicle.acceleration_down_max.value_or(kGravity), kGravity);
  return std::hypot(vehicle.acceleration_across_max, std::max(up, down));
}

}  // namespace lapwing
