// SPDX-License-Identifier: Apache-2.0
// Geometric tracking on SE(3) (Lee, Leok, McClamroch, CDC 2010), with the rates and angular
// accelerations of the plan fed forward, and without a preferred way up.
//
//   A     = m (r_d'' - g) + d v_d - m (k_i E + k_p e_r + k_v e_v)
//   R_c   = the planned attitude, turned by the least rotation that takes its z axis to A
//   f     = A . z_B
//   M     = -K_R e_R - K_w e_w + w x J w - J (w x R^T R_c w_d - R^T R_c w_d')
//   e_R   = 1/2 (R_c^T R - R^T R_c)^v,  e_w = w - R^T R_c w_d
//
//   controller = "geometric"
#include <algorithm>
#include <cmath>

#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/vehicle/flight_controller.h"

namespace lapwing {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kLeastForce = 0.05;  // of the weight: a weaker one has no direction of its own

struct Law {
  const BodyReference* reference = nullptr;
  double mass = 0, drag = 0, lag = 0;
  Vector3d inertia = Vector3d::Zero();
  ControllerGains gains;
  double largest_correction = 0;  // m/s^2
};

class GeometricFlight final : public ControlledFlight {
 public:
  GeometricFlight(const Law& law, const RotorAllocation& allocation)
      : law_(law), allocation_(allocation) {}

  RotorCommand command(double time, const BodyState& state, double step) override {
    // The command is held for a step: what the plan asks for in its middle.
    const BodyPoint wanted = law_.reference->at(time);
    const BodyPoint middle = law_.reference->at(time + step / 2);
    const Vector3d error = state.position - wanted.position;
    if (!saturated_) integral_ += step * error;
    Vector3d feedback = law_.gains.integral * integral_ + law_.gains.position * error +
                        law_.gains.velocity * (state.velocity - wanted.velocity);
    if (feedback.norm() > law_.largest_correction)
      feedback *= law_.largest_correction / feedback.norm();
    const Vector3d force = law_.mass * (middle.acceleration + Vector3d(0, 0, kGravity) - feedback) +
                           law_.drag * middle.velocity;

    const Matrix3d r = state.orientation.toRotationMatrix();
    const Matrix3d rc = attitude(wanted.orientation, force).toRotationMatrix();
    const Matrix3d skew = rc.transpose() * r - r.transpose() * rc;
    const Vector3d error_r = 0.5 * Vector3d(skew(2, 1), skew(0, 2), skew(1, 0));
    const Matrix3d carry = r.transpose() * rc;
    const Vector3d rates = carry * wanted.body_rates;
    // Rotors answer that much later.
    const Vector3d ahead =
        carry * law_.reference->at(time + step / 2 + law_.lag).body_accelerations;
    const Vector3d& omega = state.body_rates;
    const Vector3d& inertia = law_.inertia;
    const Vector3d moment =
        -law_.gains.attitude.cwiseProduct(error_r) - law_.gains.rates.cwiseProduct(omega - rates) +
        omega.cross(inertia.cwiseProduct(omega)) + inertia.cwiseProduct(ahead - omega.cross(rates));
    Eigen::Vector4d wrench;
    wrench << std::max(0.0, force.dot(r.col(2))), moment;
    const RotorCommand command = allocation_(wrench);
    saturated_ = command.saturated;
    return command;
  }

 private:
  Quaterniond attitude(const Quaterniond& planned, const Vector3d& force) const {
    if (force.norm() < kLeastForce * law_.mass * kGravity) return planned;
    const Vector3d z = planned * Vector3d::UnitZ();
    return Quaterniond::FromTwoVectors(z, force) * planned;
  }

  const Law& law_;
  const RotorAllocation& allocation_;
  Vector3d integral_ = Vector3d::Zero();  // m s
  bool saturated_ = false;
};

class Geometric final : public Controller {
 public:
  static constexpr PluginText kText{"geometric", "1.0.0",
                                    "tracking on SE(3) with feed-forward rates, also upside down",
                                    "Lee, Leok, McClamroch, CDC 2010"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .number("position", 0.1, "m", "position error of the same cost as 2 m/s^2",
                between(0.001, 10))
        .number("velocity", 0.5, "m/s", "velocity error of the same cost as 2 m/s^2",
                between(0.01, 100))
        .number("integral", 0.1, "m s",
                "integral of the position error of the same cost as 2 m/s^2", between(0.001, 100))
        .number("tilt_bandwidth", 30, "rad/s", "largest bandwidth about x and y", between(1, 100))
        .number("heading_bandwidth", 8, "rad/s", "largest bandwidth about z", between(0.1, 100))
        .number("largest_correction", 20, "m/s^2",
                "largest acceleration that corrects position errors", between(0.1, 1000));
  }
  explicit Geometric(const Parameters& parameters)
      : weights_{parameters.number("position"), parameters.number("velocity"),
                 parameters.number("integral"), parameters.number("tilt_bandwidth"),
                 parameters.number("heading_bandwidth")},
        largest_correction_(parameters.number("largest_correction")) {}

  void follow(const Vehicle& vehicle, const BodyReference& reference) override {
    law_ = {&reference,         vehicle.mass,    vehicle.drag,
            vehicle.rotors.lag, vehicle.inertia, gains_of(vehicle, weights_),
            largest_correction_};
    allocation_ = std::make_unique<RotorAllocation>(vehicle);
  }
  std::unique_ptr<ControlledFlight> begin() const override {
    return std::make_unique<GeometricFlight>(law_, *allocation_);
  }

 private:
  ControllerWeights weights_;
  double largest_correction_;
  Law law_;
  std::unique_ptr<RotorAllocation> allocation_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Geometric)
