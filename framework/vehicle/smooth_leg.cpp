// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/smooth_leg.h"

#include <algorithm>
#include <cmath>

#include "framework/core/units.h"

namespace lapwing {
namespace {

constexpr double kPathSpacing = 0.05;  // m, of the way that is timed
constexpr double kLimitShare = 0.9;    // of what the vehicle can do
constexpr double kSmoother = 4.0 / 3;  // times what the limits alone allow

// The least time of a turn from rest to rest whose angle is the fifth-order polynomial of least
// jerk: its largest rate is 15/8 of the mean, its largest acceleration 10/sqrt(3) angle / time^2.
double turning_seconds(double angle, double rate, double acceleration) {
  return std::max(15.0 / 8 * angle / rate, std::sqrt(10 / std::sqrt(3.0) * angle / acceleration));
}

}  // namespace

MotionLimits motion_limits(const Vehicle& v, double share) {
  MotionLimits limits;
  limits.speed_across = share * v.speed_across_max;
  limits.climb_speed = share * v.climb_speed_max;
  limits.descent_speed = share * v.descent_speed_max;
  limits.acceleration_across = share * v.acceleration_across_max;
  // Of the rotors half, the rest is for the controller.
  const double infinite = std::numeric_limits<double>::infinity();
  const double up = v.has_rotors ? (v.thrust_max() / v.mass - kGravity) / 2 : infinite;
  const double down = v.has_rotors ? (kGravity - v.thrust_min() / v.mass) / 2 : infinite;
  limits.acceleration_up = share * std::min(up, v.acceleration_up_max.value_or(up));
  limits.acceleration_down = share * std::min(down, v.acceleration_down_max.value_or(down));
  return limits;
}

MotionLimits within(MotionLimits limits, const PathLimits& others) {
  for (double* speed : {&limits.speed_across, &limits.climb_speed, &limits.descent_speed})
    *speed = std::min(*speed, others.speed);
  for (double* acceleration :
       {&limits.acceleration_across, &limits.acceleration_up, &limits.acceleration_down})
    *acceleration = std::min(*acceleration, others.acceleration);
  return limits;
}

double smooth_leg_seconds(const Points& way, double turn, double tilt, const Vehicle& vehicle,
                          const SmoothLegSettings& settings) {
  const double spin = vehicle.has_rotors ? vehicle.yaw_torque_max() / vehicle.inertia.z()
                                         : std::numeric_limits<double>::infinity();
  double seconds =
      turning_seconds(std::abs(turn), kLimitShare * vehicle.yaw_rate_max, kLimitShare * spin);
  if (vehicle.gimbal && tilt != 0)
    seconds = std::max(seconds, std::abs(tilt) / (kLimitShare * vehicle.gimbal->pitch_rate_max));
  if (length_of(way) > 0) {
    const Points smooth = rounded(resampled(way, kPathSpacing), settings.stray);
    const MotionLimits limits =
        within(motion_limits(vehicle, kLimitShare), {settings.speed, settings.acceleration});
    seconds = std::max(seconds, kSmoother * fastest_times(smooth, limits).back());
  }
  return seconds;
}

}  // namespace lapwing
