// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/flight_controller.h"

#include <algorithm>

#include "framework/core/units.h"
#include "framework/vehicle/riccati.h"

namespace lapwing {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

// What an acceleration of kAcceleration is worth.
constexpr double kAcceleration = 2.0;  // m/s^2
constexpr double kAttitude = 0.5;      // rad, that asks for a share of the free moment
constexpr double kMomentShare = 0.5;
constexpr double kLagShare = 0.5;   // bandwidth of the attitude times the rotors' lag
constexpr double kResponse = 0.15;  // s, of an attitude that is fast enough for these weights

double squared(double x) {
  return x * x;
}

}  // namespace

ControllerGains gains_of(const Vehicle& vehicle, const ControllerWeights& worth) {
  const Rotors& rotors = vehicle.rotors;
  const double hover = vehicle.mass * kGravity / 4;
  const double room = std::min(hover - rotors.thrust_min, rotors.thrust_max - hover);
  const Eigen::Vector4d moments = room * mixer_of(rotors).cwiseAbs().rowwise().sum();
  const double fastest = rotors.lag > 0 ? kLagShare / rotors.lag : worth.tilt_bandwidth;
  const auto bandwidth = [&](double moment, double inertia, double limit) {
    return std::min({limit, fastest, std::sqrt(kMomentShare * moment / (kAttitude * inertia))});
  };
  const Vector3d& inertia = vehicle.inertia;
  const Vector3d bandwidths(bandwidth(moments(1), inertia.x(), worth.tilt_bandwidth),
                            bandwidth(moments(2), inertia.y(), worth.tilt_bandwidth),
                            bandwidth(moments(3), inertia.z(), worth.heading_bandwidth));
  ControllerGains gains;
  gains.attitude = inertia.cwiseProduct(bandwidths.cwiseAbs2());
  gains.rates = 2 * inertia.cwiseProduct(bandwidths);

  // States: integral of the error, error, its rate; input: acceleration.
  Matrix3d a = Matrix3d::Zero();
  a(0, 1) = a(1, 2) = 1;
  const double response = 2 / bandwidths.head<2>().minCoeff() + rotors.lag;
  const double slower = std::max(1.0, response / kResponse);
  const Vector3d weights(1 / squared(worth.integral * slower * slower * slower),
                         1 / squared(worth.position * slower * slower),
                         1 / squared(worth.velocity * slower));
  const Eigen::MatrixXd k =
      regulator_gain(a, Vector3d(0, 0, 1), weights.asDiagonal(),
                     Eigen::MatrixXd::Constant(1, 1, 1 / squared(kAcceleration)));
  gains.integral = k(0, 0), gains.position = k(0, 1), gains.velocity = k(0, 2);
  return gains;
}

FlightController::FlightController(const Vehicle& vehicle, const ReferenceMotion& reference,
                                   const ControllerWeights& weights)
    : reference_(reference),
      mass_(vehicle.mass),
      lag_(vehicle.rotors.lag),
      inertia_(vehicle.inertia),
      gains_(gains_of(vehicle, weights)),
      allocation_(vehicle),
      attitudes_(reference) {}

[[gnu::flatten]] RotorCommand FlightController::command(double time, const BodyState& state,
                                                        double step) {
  const ReferencePoint wanted = reference_.at(time);
  const Vector3d error = state.position - wanted.position;
  if (!saturated_) integral_ += step * error;
  const Vector3d feedback = gains_.integral * integral_ + gains_.position * error +
                            gains_.velocity * (state.velocity - wanted.velocity);
  const Vector3d force = reference_.force(wanted) - mass_ * feedback;  // (3.14)

  const Vector3d forward = attitudes_.body_rates(time, step);
  const Vector3d ahead = attitudes_.accelerations(time + lag_, step);  // rotors answer that late
  const Quaterniond target = attitude_of(force, wanted.yaw);
  const Matrix3d r = state.orientation.toRotationMatrix(), rd = target.toRotationMatrix();
  const Matrix3d skew = rd.transpose() * r - r.transpose() * rd;
  const Vector3d error_r = 0.5 * Vector3d(skew(2, 1), skew(0, 2), skew(1, 0));
  const Vector3d carried = r.transpose() * (rd * forward);  // wanted rates, body
  const Vector3d error_rates = state.body_rates - carried;
  const Vector3d& omega = state.body_rates;
  const Vector3d moment =
      -gains_.attitude.cwiseProduct(error_r) - gains_.rates.cwiseProduct(error_rates) +
      omega.cross(inertia_.cwiseProduct(omega)) +
      inertia_.cwiseProduct(r.transpose() * (rd * ahead) - omega.cross(carried));
  Eigen::Vector4d wrench;
  wrench << force.dot(r.col(2)), moment;  // (3.15)
  RotorCommand command = allocation_(wrench);
  saturated_ = command.saturated;
  return command;
}

}  // namespace lapwing
