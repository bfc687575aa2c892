// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/settling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lapwing {
namespace {

constexpr double kSpeed = 1, kAcceleration = 1;  // m/s, m/s^2, at most
constexpr double kShortest = 1;                  // s
constexpr double kApart = 0.05;                  // s, between samples

// The share of a smooth way from rest to rest, and its first two derivatives by the share of time.
struct Ease {
  double value, rate, change;
};
Ease ease(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {t3 * (10 - 15 * t + 6 * t2), t2 * (30 - 60 * t + 30 * t2), t * (60 - 180 * t + 120 * t2)};
}
constexpr double kEaseRate = 1.875, kEaseChange = 5.7735;  // the largest of them

double duration_of(double way, double turn, const Vehicle& vehicle) {
  const double speed = std::min({kSpeed, vehicle.speed_across_max / 2, vehicle.climb_speed_max / 2,
                                 vehicle.descent_speed_max / 2});
  const double acceleration =
      std::min({kAcceleration, vehicle.acceleration_across_max / 2,
                vehicle.acceleration_up_max.value_or(2 * kAcceleration) / 2,
                vehicle.acceleration_down_max.value_or(2 * kAcceleration) / 2});
  return std::max({kShortest, kEaseRate * way / speed, std::sqrt(kEaseChange * way / acceleration),
                   kEaseRate * turn / (vehicle.yaw_rate_max / 2)});
}

}  // namespace

Trajectory settling_way(const Eigen::Vector3d& position, double yaw, const Trajectory& plan,
                        const Vehicle& vehicle) {
  Sample start = plan.samples.front();
  const Eigen::Vector3d way = start.position - position;
  const double turn = std::remainder(start.yaw - yaw, 2 * std::numbers::pi);
  const double duration = duration_of(way.norm(), std::abs(turn), vehicle);
  Trajectory settling;
  settling.inputs_held = false;
  settling.has_gimbal = plan.has_gimbal;
  settling.has_target = plan.has_target;
  start.gimbal_yaw_rate = start.gimbal_pitch_rate = 0;
  const int steps = static_cast<int>(std::ceil(duration / kApart));
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const Ease e = ease(share);
    Sample sample = start;
    sample.time = share * duration;
    sample.position = position + e.value * way;
    sample.velocity = e.rate / duration * way;
    sample.acceleration = e.change / (duration * duration) * way;
    sample.yaw = yaw + e.value * turn;
    sample.yaw_rate = e.rate / duration * turn;
    settling.samples.push_back(sample);
  }
  return settling;
}

}  // namespace lapwing
