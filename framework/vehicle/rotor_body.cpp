// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/rotor_body.h"

#include <numbers>

#include "framework/core/units.h"

namespace lapwing {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

Eigen::Matrix4d mixer_of(const Rotors& rotors) {
  Eigen::Matrix4d mixer;
  for (int i = 0; i < 4; ++i) {
    const double angle = (i + (rotors.diagonal ? 0.5 : 0.0)) * std::numbers::pi / 2;
    mixer(0, i) = 1;
    mixer(1, i) = rotors.arm_length * std::sin(angle);
    mixer(2, i) = -rotors.arm_length * std::cos(angle);
    mixer(3, i) = (i % 2 == 0 ? 1 : -1) * rotors.torque_coefficient;
  }
  return mixer;
}

RotorBody::RotorBody(const Vehicle& vehicle, double mass_factor, double inertia_factor,
                     double quadratic_drag)
    : mass_(mass_factor * vehicle.mass),
      drag_(vehicle.drag),
      quadratic_drag_(quadratic_drag),
      lag_(vehicle.rotors.lag),
      inertia_(mass_factor * inertia_factor * vehicle.inertia),
      mixer_(mixer_of(vehicle.rotors)) {}

// Time derivatives, those of the orientation as body rates.
struct RotorBody::Rates {
  Vector3d position, velocity, turn, body_rates;
};

RotorBody::Rates RotorBody::rates(const BodyState& state, const Vector3d& wind) const {
  const Vector4d u = wrench(state.rotor_thrusts);
  const Vector3d thrust = state.orientation * Vector3d(0, 0, u(0));
  const Vector3d moment = u.tail<3>();
  const Vector3d spin = inertia_.cwiseProduct(state.body_rates);
  Rates rates;
  rates.position = state.velocity;
  const Vector3d air = state.velocity - wind;
  const double drag = quadratic_drag_ > 0 ? drag_ + quadratic_drag_ * air.norm() : drag_;
  rates.velocity = (thrust - drag * air) / mass_ - Vector3d(0, 0, kGravity);
  rates.turn = state.body_rates;
  rates.body_rates = (moment - state.body_rates.cross(spin)).cwiseQuotient(inertia_);
  return rates;
}

namespace {

Quaterniond turned(const Quaterniond& from, const Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return from;
  return (from * Quaterniond(Eigen::AngleAxisd(angle, turn / angle))).normalized();
}

// d/dt of the rotation vector whose exponential the body turns by; to the order that Runge-Kutta 4
// needs.
Vector3d turn_rate(const Vector3d& turn, const Vector3d& body_rates) {
  const Vector3d once = turn.cross(body_rates);
  return body_rates + once / 2 + turn.cross(once) / 12;
}

}  // namespace

// Flat: quaternion products and crosses are small, and calls of them would cost more than they do.
[[gnu::flatten]] BodyState RotorBody::after(const BodyState& state, const Vector4d& commanded,
                                            const Vector3d& wind, double step) const {
  const BodyState& from = state;
  // The lag is solved in closed form: it may be far shorter than the step.
  const auto thrusts_after = [&](double time) -> Vector4d {
    const double left = lag_ > 0 ? std::exp(-time / lag_) : 0.0;
    return commanded + left * (from.rotor_thrusts - commanded);
  };
  const Vector4d thrusts_halfway = thrusts_after(step / 2), thrusts_at_end = thrusts_after(step);
  BodyState sum = from;
  Vector3d sum_turn = Vector3d::Zero(), turn = Vector3d::Zero();
  BodyState at = from;
  at.rotor_thrusts = lag_ > 0 ? from.rotor_thrusts : commanded;
  constexpr double kWeights[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  constexpr double kNext[] = {0.5, 0.5, 1.0};  // of the step, to the next stage
  for (int k = 0; k < 4; ++k) {
    Rates r = rates(at, wind);
    r.turn = turn_rate(turn, r.turn);
    const double share = kWeights[k] * step;
    sum.position += share * r.position;
    sum.velocity += share * r.velocity;
    sum.body_rates += share * r.body_rates;
    sum_turn += share * r.turn;
    if (k == 3) break;
    const double next = kNext[k] * step;
    turn = next * r.turn;
    at.position = from.position + next * r.position;
    at.velocity = from.velocity + next * r.velocity;
    at.body_rates = from.body_rates + next * r.body_rates;
    at.rotor_thrusts = k < 2 ? thrusts_halfway : thrusts_at_end;
    at.orientation = turned(from.orientation, turn);
  }
  sum.rotor_thrusts = thrusts_at_end;
  sum.orientation = turned(from.orientation, sum_turn);
  return sum;
}

}  // namespace lapwing
