// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/body_reference.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "framework/core/units.h"
#include "framework/vehicle/planned_attitude.h"

namespace lapwing {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

namespace {

constexpr double kGrid = 0.002;      // s, between kept states
constexpr double kMostStates = 1e6;  // of a long plan: then further apart

Quaterniond turned_by(const Quaterniond& from, const Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return from;
  return (from * Quaterniond(Eigen::AngleAxisd(angle, turn / angle))).normalized();
}

// The same rotors, without their lag: a plan states thrusts as they are.
Vehicle without_lag(Vehicle vehicle) {
  vehicle.rotors.lag = 0;
  return vehicle;
}

}  // namespace

BodyReference::BodyReference(const Trajectory& trajectory, const Vehicle& vehicle)
    : trajectory_(trajectory),
      motion_(trajectory, vehicle),
      mass_(vehicle.mass),
      drag_(vehicle.drag),
      inertia_(vehicle.inertia),
      unmix_(mixer_of(vehicle.rotors).inverse()),
      body_(std::make_unique<RotorBody>(without_lag(vehicle))) {
  if (trajectory.motion.tracked == Tracking::rotors) integrate();
}

Vector4d BodyReference::thrusts(std::size_t interval, double time) const {
  const Sample& s = trajectory_.samples[interval];
  const Sample& next = trajectory_.samples[interval + 1];
  const Vector4d now = s.columns.vector<4>("rotor_thrusts");
  if (trajectory_.inputs_held) return now;
  const double share = std::clamp((time - s.time) / (next.time - s.time), 0.0, 1.0);
  return now + share * (next.columns.vector<4>("rotor_thrusts") - now);
}

void BodyReference::integrate() {
  const auto& samples = trajectory_.samples;
  const double grid = std::max(kGrid, (finish() - start()) / kMostStates);
  const auto stated = [](const Sample& s) {
    BodyState state;
    state.position = s.position;
    state.velocity = s.velocity;
    state.orientation = s.columns.quaternion("orientation").normalized();
    state.body_rates = s.columns.vector3("body_rates");
    return state;
  };
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double length = samples[i + 1].time - samples[i].time;
    const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(length / grid)));
    const double step = length / static_cast<double>(steps);
    const std::size_t first = states_.size();
    BodyState state = stated(samples[i]);
    for (std::size_t k = 0; k < steps; ++k) {
      const double time = samples[i].time + static_cast<double>(k) * step;
      times_.push_back(time);
      intervals_.push_back(i);
      states_.push_back(state);
      state = body_->after(state, thrusts(i, time + step / 2), Vector3d::Zero(), step);
    }
    const BodyState next = stated(samples[i + 1]);
    const Vector3d off = next.position - state.position, drift = next.velocity - state.velocity;
    const Vector3d turn = rotation_vector(state.orientation.conjugate() * next.orientation);
    const Vector3d spin = next.body_rates - state.body_rates;
    for (std::size_t k = 0; k < steps; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(steps);
      BodyState& mended = states_[first + k];
      mended.position += share * off;
      mended.velocity += share * drift;
      mended.orientation = turned_by(mended.orientation, share * turn);
      mended.body_rates += share * spin;
    }
  }
  times_.push_back(samples.back().time);
  intervals_.push_back(samples.size() - 2);
  states_.push_back(stated(samples.back()));
}

BodyPoint BodyReference::at(double time) const {
  const double t = std::clamp(time, start(), finish());
  BodyPoint point;
  if (!states_attitude()) {
    const ReferencePoint wanted = motion_.at(t);
    const AttitudeReference attitude = planned_attitude(motion_, t);
    point.position = wanted.position;
    point.velocity = wanted.velocity;
    point.acceleration = wanted.acceleration;
    point.orientation = attitude.orientation;
    point.body_rates = attitude.body_rates;
    point.body_accelerations = attitude.accelerations;
    const Vector3d& w = attitude.body_rates;
    Vector4d wrench;
    wrench << motion_.force(wanted).norm(),
        inertia_.cwiseProduct(attitude.accelerations) + w.cross(inertia_.cwiseProduct(w));
    point.rotor_thrusts = unmix_ * wrench;
    return point;
  }
  const auto after = std::upper_bound(times_.begin() + 1, times_.end(), t);
  const std::size_t k = static_cast<std::size_t>(after - times_.begin()) - 1;
  const double ahead = t - times_[k];
  const std::size_t i = intervals_[k];
  BodyState state = states_[k];
  if (ahead > 0)
    state = body_->after(state, thrusts(i, times_[k] + ahead / 2), Vector3d::Zero(), ahead);
  point.position = state.position;
  point.velocity = state.velocity;
  point.orientation = state.orientation;
  point.body_rates = state.body_rates;
  point.rotor_thrusts = thrusts(i, t);
  const Vector4d wrench = body_->wrench(point.rotor_thrusts);
  point.acceleration =
      (state.orientation * Vector3d(0, 0, wrench(0)) - drag_ * state.velocity) / mass_ -
      Vector3d(0, 0, kGravity);
  const Vector3d& w = state.body_rates;
  point.body_accelerations =
      (Vector3d(wrench.tail<3>()) - w.cross(inertia_.cwiseProduct(w))).cwiseQuotient(inertia_);
  return point;
}

BodyState BodyReference::starting_state() const {
  const BodyPoint first = at(start());
  BodyState state;
  state.position = first.position;
  state.velocity = first.velocity;
  state.orientation = first.orientation;
  state.body_rates = first.body_rates;
  state.rotor_thrusts = states_attitude()
                            ? first.rotor_thrusts
                            : Vector4d::Constant(motion_.force(motion_.at(start())).norm() / 4);
  return state;
}

}  // namespace lapwing
