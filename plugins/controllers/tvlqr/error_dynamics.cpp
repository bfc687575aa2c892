// SPDX-License-Identifier: Apache-2.0
#include "plugins/controllers/tvlqr/error_dynamics.h"

#include "framework/vehicle/planned_attitude.h"

namespace lapwing {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

Matrix3d cross(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

ErrorDynamics error_dynamics(const BodyPoint& point, const Vehicle& vehicle) {
  const bool rotors = vehicle.rotors.lag > 0;
  const int n = kBodyErrors + (rotors ? kRotorErrors : 0);
  const Matrix3d r = point.orientation.toRotationMatrix(), one = Matrix3d::Identity();
  const Matrix4d mixer = mixer_of(vehicle.rotors);
  const double thrust = point.rotor_thrusts.sum();
  const Vector3d& w = point.body_rates;
  const Matrix3d inertia = vehicle.inertia.asDiagonal();
  const Matrix3d inverse = vehicle.inertia.cwiseInverse().asDiagonal();
  ErrorDynamics d{MatrixXd::Zero(n, n), MatrixXd::Zero(n, 4)};
  d.a.block<3, 3>(0, 3) = one;
  d.a.block<3, 3>(3, 6) = one;
  d.a.block<3, 3>(6, 6) = -vehicle.drag / vehicle.mass * one;
  d.a.block<3, 3>(6, 9) = -thrust / vehicle.mass * r * cross(Vector3d::UnitZ());
  d.a.block<3, 3>(9, 9) = -cross(w);
  d.a.block<3, 3>(9, 12) = one;
  d.a.block<3, 3>(12, 12) = inverse * (cross(inertia * w) - cross(w) * inertia);
  MatrixXd by_thrusts = MatrixXd::Zero(kBodyErrors, 4);
  by_thrusts.block<3, 4>(6, 0) = r.col(2) / vehicle.mass * mixer.row(0);
  by_thrusts.block<3, 4>(12, 0) = inverse * mixer.bottomRows<3>();
  if (!rotors) {
    d.b.topRows<kBodyErrors>() = by_thrusts;
    return d;
  }
  d.a.block<kBodyErrors, 4>(0, kBodyErrors) = by_thrusts;
  d.a.block<4, 4>(kBodyErrors, kBodyErrors) = -Matrix4d::Identity() / vehicle.rotors.lag;
  d.b.block<4, 4>(kBodyErrors, 0) = Matrix4d::Identity() / vehicle.rotors.lag;
  return d;
}

Eigen::VectorXd deviation(const BodyState& state, const BodyPoint& point, const Vector3d& integral,
                          bool with_rotors) {
  Eigen::VectorXd x(kBodyErrors + (with_rotors ? kRotorErrors : 0));
  x.segment<3>(0) = integral;
  x.segment<3>(3) = state.position - point.position;
  x.segment<3>(6) = state.velocity - point.velocity;
  x.segment<3>(9) = rotation_vector(point.orientation.conjugate() * state.orientation);
  x.segment<3>(12) = state.body_rates - point.body_rates;
  if (with_rotors) x.segment<4>(15) = state.rotor_thrusts - point.rotor_thrusts;
  return x;
}

}  // namespace lapwing
