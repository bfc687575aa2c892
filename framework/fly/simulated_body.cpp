// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/simulated_body.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/vehicle/planned_attitude.h"

namespace lapwing {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double kSmoothing = 0.03;     // s, of the acceleration that is fed forward
constexpr double kLongestAimGap = 0.1;  // s between setpoints of which rates are taken
constexpr double kUsualGap = 0.02;      // s
constexpr double kMostTurning = 20;     // rad/s^2

const Vehicle& with_rotors(const Vehicle& vehicle) {
  if (!vehicle.has_rotors)
    throw InputError("vehicle '" + vehicle.name +
                     "' states no rotors: its flight cannot be simulated");
  return vehicle;
}

}  // namespace

SimulatedBody::SimulatedBody(const Vehicle& vehicle, const Vector3d& position, double yaw)
    : vehicle_(with_rotors(vehicle)),
      body_(vehicle),
      gains_(gains_of(vehicle)),
      allocation_(vehicle) {
  state_.position = position;
  state_.orientation = planned_ = attitude_of(Vector3d::UnitZ(), yaw);
  state_.rotor_thrusts.setConstant(vehicle.mass * kGravity / 4);
  setpoint_.position = position;
  setpoint_.yaw = yaw;
}

Vector3d SimulatedBody::fed_force() const {
  return vehicle_.mass * (forward_ + kGravity * Vector3d::UnitZ()) +
         vehicle_.drag * setpoint_.velocity;
}

// Rates and the turning are those from the last setpoint to this one. Of setpoints that come
// irregularly the stated yaw rate is taken, and no turning: differences would be those of the link.
void SimulatedBody::aim(const Setpoint& setpoint) {
  setpoint_ = setpoint;
  const double passed = steps_ * kStep;
  if (steps_ == 0) return;
  steps_ = 0;
  const Quaterniond planned = attitude_of(fed_force(), setpoint.yaw);
  Vector3d rates = Vector3d::Zero();
  if (passed <= kLongestAimGap) rates = rotation_vector(planned_.conjugate() * planned) / passed;
  const bool regular = std::abs(passed - kUsualGap) < kUsualGap / 2;
  if (!regular) rates.z() = setpoint.yaw_rate * (planned * Vector3d::UnitZ()).z();
  turning_ = regular && regular_
                 ? std::clamp((rates.z() - rates_.z()) / passed, -kMostTurning, kMostTurning)
                 : 0;
  regular_ = regular;
  rates_ = rates;
  planned_ = planned;
}

double SimulatedBody::yaw() const {
  const Vector3d y = state_.orientation * Vector3d::UnitY();
  return std::atan2(-y.x(), y.y());
}

void SimulatedBody::advance() {
  forward_ += kStep / kSmoothing * (setpoint_.acceleration - forward_);
  // Without setpoints nothing turns.
  if (++steps_ * kStep > kLongestAimGap) rates_.setZero(), turning_ = 0;
  const Vector3d error = state_.position - setpoint_.position;
  if (!saturated_) integral_ += kStep * error;
  const Vector3d force =
      fed_force() - vehicle_.mass * (gains_.integral * integral_ + gains_.position * error +
                                     gains_.velocity * (state_.velocity - setpoint_.velocity));

  const Quaterniond target = attitude_of(force, setpoint_.yaw);
  const Matrix3d r = state_.orientation.toRotationMatrix(), rd = target.toRotationMatrix();
  const Matrix3d skew = rd.transpose() * r - r.transpose() * rd;
  const Vector3d error_r = 0.5 * Vector3d(skew(2, 1), skew(0, 2), skew(1, 0));
  const Vector3d& omega = state_.body_rates;
  const Vector3d moment = -gains_.attitude.cwiseProduct(error_r) -
                          gains_.rates.cwiseProduct(omega - r.transpose() * (rd * rates_)) +
                          omega.cross(vehicle_.inertia.cwiseProduct(omega)) +
                          Vector3d(0, 0, vehicle_.inertia.z() * turning_);
  Eigen::Vector4d wrench;
  wrench << force.dot(r.col(2)), moment;
  const RotorCommand command = allocation_(wrench);
  saturated_ = command.saturated;
  state_ = body_.after(state_, command.thrusts, Vector3d::Zero(), kStep);
}

}  // namespace lapwing
