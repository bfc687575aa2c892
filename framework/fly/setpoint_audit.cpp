// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/setpoint_audit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "framework/core/number_text.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

constexpr double kSlack = 2e-3;          // of a limit: numbers on the wire are rounded
constexpr double kPlaceSlack = 0.05;     // m; degE7 are 1 cm
constexpr double kStampSlack = 2e-3;     // s: stamps are whole ms
constexpr double kLongestStep = 0.5;     // s between setpoints that are compared
constexpr double kYawSlack = 0.02;       // rad
constexpr double kVelocitySlack = 5e-3;  // m/s; the wire has single precision

double speed_share(const Eigen::Vector3d& v, const Vehicle& vehicle) {
  return std::max({v.head<2>().norm() / vehicle.speed_across_max, v.z() / vehicle.climb_speed_max,
                   -v.z() / vehicle.descent_speed_max});
}

double acceleration_share(const Setpoint& setpoint, const Vehicle& vehicle) {
  const Eigen::Vector3d& a = setpoint.acceleration;
  double share = a.head<2>().norm() / vehicle.acceleration_across_max;
  if (vehicle.acceleration_up_max) share = std::max(share, a.z() / *vehicle.acceleration_up_max);
  if (vehicle.acceleration_down_max)
    share = std::max(share, -a.z() / *vehicle.acceleration_down_max);
  if (!vehicle.has_rotors) return share;
  const double thrust =
      (vehicle.mass * (a + kGravity * Eigen::Vector3d::UnitZ()) + vehicle.drag * setpoint.velocity)
          .norm();
  share = std::max(share, thrust / (4 * vehicle.rotors.thrust_max));
  return std::max(share, 4 * vehicle.rotors.thrust_min / std::max(thrust, 1e-9));
}

// The share of the acceleration that a change of velocity within `step` seconds needs.
double change_share(const Eigen::Vector3d& change, double step, const Vehicle& vehicle) {
  const auto share = [&](double part, std::optional<double> limit) {
    return limit ? std::max(0.0, part - kVelocitySlack) / (*limit * (step + kStampSlack)) : 0.0;
  };
  return std::max({share(change.head<2>().norm(), vehicle.acceleration_across_max),
                   share(change.z(), vehicle.acceleration_up_max),
                   share(-change.z(), vehicle.acceleration_down_max)});
}

}  // namespace

void SetpointAudit::take(const Setpoint& setpoint, double stamp, double now) {
  if (count_ > 0) gap_worst_ = std::max(gap_worst_, now - last_);
  if (count_++ == 0) first_ = now;
  last_ = now;
  const double speed = speed_share(setpoint.velocity, vehicle_);
  const double acceleration = acceleration_share(setpoint, vehicle_);
  const double yaw = std::abs(setpoint.yaw_rate) / vehicle_.yaw_rate_max;
  bool beyond = std::max({speed, acceleration, yaw}) > 1 + kSlack;
  speed_share_ = std::max(speed_share_, speed);
  acceleration_share_ = std::max(acceleration_share_, acceleration);
  yaw_share_ = std::max(yaw_share_, yaw);
  const double step = stamp - before_stamp_;
  if (before_ && step > 0 && step < kLongestStep) {
    const Eigen::Vector3d mean = 0.5 * (before_->velocity + setpoint.velocity);
    const double jump = (setpoint.position - before_->position - step * mean).norm();
    const double change = (setpoint.acceleration - before_->acceleration).norm();
    // What the trapezoidal rule leaves where the acceleration changes within the step.
    const double allowed = kPlaceSlack + kStampSlack * mean.norm() + change * step * step / 4;
    const double turn = std::abs(std::remainder(setpoint.yaw - before_->yaw, 2 * std::numbers::pi));
    const bool spun =
        turn > (1 + kSlack) * vehicle_.yaw_rate_max * (step + kStampSlack) + kYawSlack;
    jump_worst_ = std::max(jump_worst_, jump);
    const double pushed = change_share(setpoint.velocity - before_->velocity, step, vehicle_);
    acceleration_share_ = std::max(acceleration_share_, pushed);
    beyond = beyond || jump > allowed || spun || pushed > 1 + kSlack;
  }
  if (beyond) ++beyond_;
  before_ = setpoint;
  before_stamp_ = stamp;
}

std::string SetpointAudit::in_words() const {
  const auto percent = [](double share) { return plain_number(100 * share, 3) + " %"; };
  return "speed " + percent(speed_share_) + ", acceleration " + percent(acceleration_share_) +
         ", yaw rate " + percent(yaw_share_) + " of the limits, jump " +
         plain_number(jump_worst_, 2) + " m";
}

Value SetpointAudit::to_value() const {
  Value value = Value::map();
  value.set("count", static_cast<std::int64_t>(count_));
  value.set("rate", last_ > first_ ? static_cast<double>(count_ - 1) / (last_ - first_) : 0.0);
  value.set("gap_worst", gap_worst_);
  value.set("speed_share_worst", speed_share_);
  value.set("acceleration_share_worst", acceleration_share_);
  value.set("yaw_rate_share_worst", yaw_share_);
  value.set("jump_worst", jump_worst_);
  value.set("beyond_limits", static_cast<std::int64_t>(beyond_));
  return value;
}

}  // namespace lapwing
