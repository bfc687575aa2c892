// SPDX-License-Identifier: Apache-2.0
#include "plugins/controllers/predictive/observer.h"

#include <algorithm>

#include <Eigen/LU>

#include "framework/core/units.h"

namespace lapwing {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

namespace {

constexpr double kVelocityNoise = 0.02;  // m/s, of one estimate
constexpr double kThrustSpread = 0.1;    // share, before anything is seen
constexpr double kForceSpread = 1.0;     // m/s^2, likewise
constexpr double kMostThrust = 0.5;      // share, that is believed
constexpr double kMostForce = 20.0;      // m/s^2, likewise

}  // namespace

ModelObserver::ModelObserver(const Vehicle& vehicle, double bandwidth)
    : body_(vehicle), mass_(vehicle.mass), bandwidth_(bandwidth) {
  const double force = kForceSpread * kForceSpread;
  covariance_ = Vector4d(kThrustSpread * kThrustSpread, force, force, force).asDiagonal();
}

void ModelObserver::see(const BodyState& state, const Vector4d& commanded, double step) {
  const std::optional<BodyState> before = before_;
  before_ = state;
  if (!before || bandwidth_ == 0 || !(step > 0)) return;
  const BodyState expected = body_.after(*before, commanded, Vector3d::Zero(), step);
  const Vector3d seen = (state.velocity - expected.velocity) / step;
  if (!seen.allFinite() || seen.norm() > 10 * kMostForce) return;  // not one motion
  // Walks whose filter settles at this bandwidth.
  const double noise = 2 * kVelocityNoise * kVelocityNoise / (step * step);
  const double walk = bandwidth_ * bandwidth_ * noise * step * step;
  covariance_.diagonal() += Vector4d(walk / (kGravity * kGravity) / 4, walk, walk, walk);
  const double thrust = (before->rotor_thrusts + state.rotor_thrusts).sum() / 2 / mass_;
  Eigen::Matrix<double, 3, 4> h;
  h << thrust * (state.orientation * Vector3d::UnitZ()), Matrix3d::Identity();
  const Matrix3d spread = h * covariance_ * h.transpose() + noise * Matrix3d::Identity();
  const Eigen::Matrix<double, 4, 3> gain = covariance_ * h.transpose() * spread.inverse();
  estimate_ += gain * (seen - h * estimate_);
  covariance_ = (covariance_ - gain * h * covariance_).eval();
  covariance_ = ((covariance_ + covariance_.transpose()) / 2).eval();
  estimate_(0) = std::clamp(estimate_(0), -kMostThrust, kMostThrust);
  if (const double norm = estimate_.tail<3>().norm(); norm > kMostForce)
    estimate_.tail<3>() *= kMostForce / norm;
}

}  // namespace lapwing
