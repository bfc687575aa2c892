// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/flight_record.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lapwing {
namespace {

constexpr double kKept = 5;           // s
constexpr double kLongestHeld = 0.1;  // s, after the last setpoint: it still holds
constexpr double kLongestGap = 0.5;   // s, between setpoints: beyond it nobody knows

}  // namespace

void FlightRecord::sent(const Setpoint& setpoint, double time) {
  ++setpoints_;
  sent_.push_back({time, setpoint});
  while (sent_.front().time < time - kKept) sent_.pop_front();
}

std::optional<Setpoint> FlightRecord::at(double time) const {
  const auto after = std::lower_bound(sent_.begin(), sent_.end(), time,
                                      [](const Sent& s, double t) { return s.time < t; });
  if (after == sent_.begin()) return std::nullopt;
  if (after == sent_.end()) {
    Setpoint last = sent_.back().setpoint;
    const double since = time - sent_.back().time;
    if (since > kLongestHeld) return std::nullopt;
    last.position += since * last.velocity;
    last.yaw += since * last.yaw_rate;
    last.plan_time += since * last.rate;
    return last;
  }
  const Sent &a = *(after - 1), &b = *after;
  if (b.time - a.time > kLongestGap) return std::nullopt;
  const double share = (time - a.time) / std::max(1e-9, b.time - a.time);
  Setpoint mixed = a.setpoint;
  mixed.position += share * (b.setpoint.position - a.setpoint.position);
  mixed.yaw += share * (b.setpoint.yaw - a.setpoint.yaw);
  mixed.plan_time += share * (b.setpoint.plan_time - a.setpoint.plan_time);
  return mixed;
}

std::optional<double> FlightRecord::placed(const Eigen::Vector3d& p_W, double time) {
  const std::optional<Setpoint> wanted = at(time);
  if (!wanted) return std::nullopt;
  const double error = (p_W - wanted->position).norm();
  ++measured_;
  sum_ += error;
  if (error > place_worst_.error) place_worst_ = {error, wanted->plan_time};
  return error;
}

void FlightRecord::headed(double yaw, double time) {
  const std::optional<Setpoint> wanted = at(time);
  if (!wanted) return;
  const double error = std::abs(std::remainder(yaw - wanted->yaw, 2 * std::numbers::pi));
  if (error > yaw_worst_.error) yaw_worst_ = {error, wanted->plan_time};
}

}  // namespace lapwing
