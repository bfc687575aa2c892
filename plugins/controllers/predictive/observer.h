// SPDX-License-Identifier: Apache-2.0
// What accelerates a vehicle beside its model, from how its velocity changes: a Kalman filter of
// four random walks.
#pragma once

#include <optional>

#include "framework/vehicle/rotor_body.h"

namespace lapwing {

class ModelObserver {
 public:
  // `bandwidth`: rad/s, of both estimates near hovering; 0: nothing is ever found.
  ModelObserver(const Vehicle& vehicle, double bandwidth);

  // After `step` seconds under the thrusts `commanded` the vehicle is in this state.
  void see(const BodyState& state, const Eigen::Vector4d& commanded, double step);

  double thrust() const { return estimate_(0); }
  Eigen::Vector3d acceleration() const { return estimate_.tail<3>(); }

 private:
  RotorBody body_;
  double mass_, bandwidth_;
  std::optional<BodyState> before_;
  Eigen::Vector4d estimate_ = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance_;
};

}  // namespace lapwing
