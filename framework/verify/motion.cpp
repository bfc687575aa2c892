#include "framework/verify/motion.h"

#include "framework/core/units.h"
#include "framework/vehicle/rotor_body.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

struct Inputs {
  Eigen::Vector3d force;
  double yaw_torque, gimbal_yaw_rate, gimbal_pitch_rate;
};

Inputs inputs_of(const Sample& s) {
  return {s.force, s.yaw_torque, s.gimbal_yaw_rate, s.gimbal_pitch_rate};
}

Inputs inputs_between(const Inputs& a, const Inputs& b, double share) {
  return {a.force + share * (b.force - a.force),
          a.yaw_torque + share * (b.yaw_torque - a.yaw_torque),
          a.gimbal_yaw_rate + share * (b.gimbal_yaw_rate - a.gimbal_yaw_rate),
          a.gimbal_pitch_rate + share * (b.gimbal_pitch_rate - a.gimbal_pitch_rate)};
}

struct State {
  Eigen::Vector3d position, velocity;
  double yaw, yaw_rate, gimbal_yaw, gimbal_pitch;
};

State advanced(const State& x, const State& rate, double h) {
  return {x.position + h * rate.position,
          x.velocity + h * rate.velocity,
          x.yaw + h * rate.yaw,
          x.yaw_rate + h * rate.yaw_rate,
          x.gimbal_yaw + h * rate.gimbal_yaw,
          x.gimbal_pitch + h * rate.gimbal_pitch};
}

}  // namespace

Motion::Motion(const Trajectory& trajectory, const Vehicle& vehicle)
    : trajectory_(trajectory),
      mass_(vehicle.mass),
      yaw_inertia_(vehicle.inertia.z()),
      drag_(vehicle.drag),
      inertia_(vehicle.inertia),
      mixer_(mixer_of(vehicle.rotors)) {}

double Motion::steps(std::size_t interval) const {
  namespace tol = tolerances;
  const Sample& a = trajectory_.samples[interval];
  const Sample& b = trajectory_.samples[interval + 1];
  const double h = b.time - a.time;
  if (trajectory_.model == MotionModel::path) {
    return std::ceil(std::max(1.0, h / tol::kStepMaximum));
  }
  if (trajectory_.model == MotionModel::rotors)
    return std::ceil(std::max(1.0, h / tol::kRotorStep));
  const Eigen::Vector3d gravity(0, 0, -kGravity);
  const double acceleration =
      std::max((a.force / mass_ + gravity).norm(), (b.force / mass_ + gravity).norm());
  // With linear inputs a speed may peak between two points: by |change of acceleration| step / 8.
  const double change = trajectory_.inputs_held ? 0.0 : 1.0;
  const double hidden_speed = change * (b.force - a.force).norm() / mass_ * h / 8;
  const double hidden_yaw_rate =
      change * std::abs(b.yaw_torque - a.yaw_torque) / yaw_inertia_ * h / 8;
  const double hidden_gimbal = change * h / 8 *
                               std::max(std::abs(b.gimbal_yaw_rate - a.gimbal_yaw_rate),
                                        std::abs(b.gimbal_pitch_rate - a.gimbal_pitch_rate));
  return std::ceil(
      std::max({1.0, h / tol::kStepMaximum, h * std::sqrt(acceleration / (8 * tol::kBulge)),
                std::sqrt(hidden_speed / tol::kHiddenSpeed),
                std::sqrt(hidden_yaw_rate / tol::kHiddenYawRate),
                std::sqrt(hidden_gimbal / tol::kHiddenGimbal)}));
}

double Motion::total_steps() const {
  double total = 0;
  for (std::size_t i = 0; i < intervals(); ++i) total += steps(i);
  return total;
}

MotionPoint Motion::stated(std::size_t index) const {
  const Sample& s = trajectory_.samples[index];
  if (trajectory_.model == MotionModel::path) {
    return {.time = s.time,
            .position = s.position,
            .yaw = s.yaw,
            .gimbal_yaw = s.gimbal_yaw,
            .gimbal_pitch = s.gimbal_pitch};
  }
  if (trajectory_.model == MotionModel::rotors) return stated_rotors(index);
  const Eigen::Vector3d gravity(0, 0, -kGravity);
  return {.time = s.time,
          .position = s.position,
          .velocity = s.velocity,
          .acceleration = s.force / mass_ + gravity,
          .force = s.force,
          .yaw = s.yaw,
          .yaw_rate = s.yaw_rate,
          .yaw_torque = s.yaw_torque,
          .gimbal_yaw = s.gimbal_yaw,
          .gimbal_pitch = s.gimbal_pitch,
          .gimbal_yaw_rate = s.gimbal_yaw_rate,
          .gimbal_pitch_rate = s.gimbal_pitch_rate};
}

std::span<const MotionPoint> Motion::follow_line(std::size_t interval) {
  const MotionPoint a = stated(interval), b = stated(interval + 1);
  const auto count = static_cast<std::size_t>(steps(interval));
  const double h = b.time - a.time;
  points_.clear();
  for (std::size_t k = 0; k <= count; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(count);
    points_.push_back({.time = k == count ? b.time : a.time + s * h,
                       .position = a.position + s * (b.position - a.position),
                       .velocity = (b.position - a.position) / h,
                       .yaw = a.yaw + s * (b.yaw - a.yaw),
                       .yaw_rate = (b.yaw - a.yaw) / h,
                       .gimbal_yaw = a.gimbal_yaw + s * (b.gimbal_yaw - a.gimbal_yaw),
                       .gimbal_pitch = a.gimbal_pitch + s * (b.gimbal_pitch - a.gimbal_pitch),
                       .gimbal_yaw_rate = (b.gimbal_yaw - a.gimbal_yaw) / h,
                       .gimbal_pitch_rate = (b.gimbal_pitch - a.gimbal_pitch) / h});
  }
  return points_;
}

std::span<const MotionPoint> Motion::integrate(std::size_t interval) {
  if (watcher_) watcher_(interval);
  if (trajectory_.model == MotionModel::path) return follow_line(interval);
  if (trajectory_.model == MotionModel::rotors) return turn_rotors(interval);
  const Sample& a = trajectory_.samples[interval];
  const Sample& b = trajectory_.samples[interval + 1];
  const Inputs first = inputs_of(a), last = trajectory_.inputs_held ? first : inputs_of(b);
  const Eigen::Vector3d gravity(0, 0, -kGravity);
  const auto rate = [&](const State& x, double share) -> State {
    const Inputs u = inputs_between(first, last, share);
    return {x.velocity,        u.force / mass_ + gravity, x.yaw_rate, u.yaw_torque / yaw_inertia_,
            u.gimbal_yaw_rate, u.gimbal_pitch_rate};
  };
  const auto count = static_cast<std::size_t>(steps(interval));
  const double h = (b.time - a.time) / static_cast<double>(count);
  State x{a.position, a.velocity, a.yaw, a.yaw_rate, a.gimbal_yaw, a.gimbal_pitch};
  points_.clear();
  points_.push_back(stated(interval));
  for (std::size_t k = 0; k < count; ++k) {
    const auto share = [&](double part) {
      return (static_cast<double>(k) + part) / static_cast<double>(count);
    };
    const State k1 = rate(x, share(0));
    const State k2 = rate(advanced(x, k1, h / 2), share(0.5));
    const State k3 = rate(advanced(x, k2, h / 2), share(0.5));
    const State k4 = rate(advanced(x, k3, h), share(1));
    x = advanced(x, k1, h / 6);
    x = advanced(x, k2, h / 3);
    x = advanced(x, k3, h / 3);
    x = advanced(x, k4, h / 6);
    const Inputs u = inputs_between(first, last, share(1));
    points_.push_back({.time = k + 1 == count ? b.time : a.time + h * static_cast<double>(k + 1),
                       .position = x.position,
                       .velocity = x.velocity,
                       .acceleration = u.force / mass_ + gravity,
                       .force = u.force,
                       .yaw = x.yaw,
                       .yaw_rate = x.yaw_rate,
                       .yaw_torque = u.yaw_torque,
                       .gimbal_yaw = x.gimbal_yaw,
                       .gimbal_pitch = x.gimbal_pitch,
                       .gimbal_yaw_rate = u.gimbal_yaw_rate,
                       .gimbal_pitch_rate = u.gimbal_pitch_rate});
  }
  return points_;
}

}  // namespace lapwing
