// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/plan_pacer.h"

#include <algorithm>
#include <cmath>

#include "framework/core/units.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kRest = 0.05;         // m/s: a plan begins or ends at rest below it
constexpr double kLeastSpeed = 0.3;    // m/s, for the change of pace where the plan hardly moves
constexpr double kRampTime = 0.4;      // s, to the full brake
constexpr double kLongestRamp = 4;     // 1/s, of the rate where the plan hardly moves
constexpr double kStands = 1e-9;       // of the rate
constexpr double kGentle = 0.6;        // of the jerk, that a change of pace ends with
constexpr double kRounding = 1e-6;     // of a limit
constexpr double kSimulated = 0.02;    // s, of a brake that is tried
constexpr double kStopMargin = 0.005;  // s of the plan, before its end
constexpr double kThere = 0.1;         // m, from the last place: near enough
constexpr double kLastMoment = 1e-9;   // s, for rounding

// The largest share of its limits that a setpoint needs, in still air.
double share_of_limits(const Setpoint& setpoint, const Vehicle& vehicle) {
  const Vector3d& a = setpoint.acceleration;
  double share = a.head<2>().norm() / vehicle.acceleration_across_max;
  if (vehicle.acceleration_up_max) share = std::max(share, a.z() / *vehicle.acceleration_up_max);
  if (vehicle.acceleration_down_max)
    share = std::max(share, -a.z() / *vehicle.acceleration_down_max);
  if (!vehicle.has_rotors) return share;
  const double thrust =
      (vehicle.mass * (a + kGravity * Vector3d::UnitZ()) + vehicle.drag * setpoint.velocity).norm();
  share = std::max(share, thrust / vehicle.thrust_max());
  return std::max(share, vehicle.thrust_min() / std::max(thrust, 1e-9));
}

// The largest change of pace from which steps of `jerk` * `step` lead to none, with the pace just
// there: the steps after it cover, with it, no more than what is `left`. Of a change (m + f) jerk
// step, 0 <= f < 1, they cover jerk step^2 (m + 1) (m / 2 + f).
double ending_change(double left, double jerk, double step) {
  if (!(left > 0)) return 0;
  const double covered = left / (jerk * step * step);
  const double m = std::floor((std::sqrt(8 * covered + 1) - 1) / 2);
  return (m / 2 + covered / (m + 1)) * jerk * step;
}

}  // namespace

PlanPacer::PlanPacer(const Trajectory& trajectory, const Vehicle& vehicle)
    : trajectory_(trajectory), vehicle_(vehicle) {
  time_ = trajectory.samples.front().time;
  end_ = trajectory.samples.back().time;
  brake_ = 0.5 * vehicle.acceleration_across_max;
  jerk_ = brake_ / kRampTime;
  if (vehicle.jerk_max) jerk_ = std::min(jerk_, 0.5 * *vehicle.jerk_max);
  if (trajectory.samples.front().velocity.norm() > kRest) rate_ = 0;
  ends_in_motion_ = trajectory.samples.back().velocity.norm() > kRest;
  double fastest = 0;
  for (const Sample& s : trajectory.samples) fastest = std::max(fastest, s.velocity.norm());
  longest_brake_ = fastest / brake_ + 6 * brake_ / jerk_;
}

Setpoint PlanPacer::at(const Pace& pace) const {
  const double time = std::clamp(pace.time, trajectory_.samples.front().time, end_);
  const Sample s = sample_at(trajectory_, time);
  // Beyond the end the plan stands still.
  const double rate = pace.time > end_ ? 0 : pace.rate;
  const double change = pace.time > end_ ? 0 : pace.change;
  return {time,
          rate,
          s.position,
          s.velocity * rate,
          s.acceleration * rate * rate + s.velocity * change,
          s.yaw,
          s.yaw_rate * rate,
          s.gimbal_yaw,
          s.gimbal_pitch,
          s.target};
}

// By how much the limits are exceeded, and those of the plan itself: a share.
double PlanPacer::excess(const Pace& pace) const {
  const double planned = share_of_limits(at({pace.time, 1, 0}), vehicle_);
  const double needed = share_of_limits(at(pace), vehicle_);
  return needed - std::max(1.0, planned) - kRounding;
}

double PlanPacer::speed_at(double time) const {
  return std::max(kLeastSpeed, sample_at(trajectory_, std::min(time, end_)).velocity.norm());
}

double PlanPacer::wanted_change(const Pace& pace, double step, bool run) const {
  const double speed = speed_at(pace.time);
  const double most = std::min(brake_ / speed, kLongestRamp);
  const double left = run ? 1 - pace.rate : pace.rate;
  const double wanted = std::min(most, ending_change(left, kGentle * jerk_ / speed, step));
  return run ? wanted : -wanted;
}

PlanPacer::Pace PlanPacer::after(const Pace& pace, double step, bool run) const {
  const double ramp = jerk_ / speed_at(pace.time) * step;
  const double low = pace.change - ramp, high = pace.change + ramp;
  const auto moved = [&](double change) {
    Pace next{pace.time, std::clamp(pace.rate + change * step, 0.0, 1.0), change};
    next.time += 0.5 * (pace.rate + next.rate) * step;
    if (!run && next.rate < kStands) next.rate = 0;
    return next;
  };
  const double smooth = std::clamp(wanted_change(pace, step, run), low, high);
  Pace best = moved(smooth);
  double least = excess(best);
  const auto allowed = [&](double change) {
    const Pace tried = moved(change);
    const double over = excess(tried);
    if (over < least) best = tried, least = over;
    return least <= 0;
  };
  if (least <= 0) return best;
  // The nearest change that the limits allow within the jerk; else the nearest one that they allow;
  // else the one that exceeds them least.
  constexpr int kTried = 16;
  for (int k = 1; k <= kTried; ++k) {
    const double share = static_cast<double>(k) / kTried;
    if (allowed(smooth + share * (low - smooth)) || allowed(smooth + share * (high - smooth)))
      return best;
  }
  for (int k = 1; k <= kTried; ++k) {
    const double share = static_cast<double>(k) / kTried;
    if (allowed(smooth * (1 - share)) || allowed(-smooth * share)) return best;
  }
  return best;
}

// Whether a brake from here comes to a stop before the end.
bool PlanPacer::stops_in_time(Pace pace) const {
  while (pace.rate > 0 && pace.time < end_) pace = after(pace, kSimulated, false);
  return pace.rate == 0 && pace.time <= end_ - kStopMargin;
}

// Of a plan that ends in motion: whether the plan may go on for `step` seconds. A brake takes no
// longer than `longest_brake_`.
bool PlanPacer::may_run(double step) const {
  if (!ends_in_motion_ || time_ < end_ - longest_brake_) return true;
  return stops_in_time(after({time_, rate_, change_}, step, true));
}

void PlanPacer::advance(double step, bool run) {
  if (finished_) return;
  const bool goes_on = may_run(step);
  if (run && rate_ == 0 && ends_in_motion_) {
    const double left = (sample_at(trajectory_, end_).position - at({time_, 0, 0}).position).norm();
    if (!goes_on || (time_ > end_ - longest_brake_ && left < kThere)) {
      finished_ = true;
      return;
    }
  }
  const Pace next = after({time_, rate_, change_}, step, run && goes_on);
  time_ = next.time, rate_ = next.rate, change_ = next.change;
  if (time_ < end_ - kLastMoment) return;
  finished_ = true;
  time_ = end_, rate_ = 0, change_ = 0;
}

Setpoint PlanPacer::setpoint(double ahead) const {
  if (finished_) return at({time_, 0, 0});
  return at({time_ + ahead * rate_, rate_, change_});
}

}  // namespace lapwing
