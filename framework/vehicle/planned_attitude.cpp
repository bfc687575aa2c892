// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/planned_attitude.h"

#include <algorithm>
#include <cmath>

namespace lapwing {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {
constexpr double kDifference = 0.01;    // s, of the attitude's derivatives
constexpr double kAlongHeading = 1e-3;  // sine of the angle between force and heading
constexpr double kOnStep = 1e-6;        // of a step: times so near to one are at it
// Steps that are kept: more than a difference of 0.01 s at steps of 0.1 ms and usual lags span.
constexpr std::int64_t kKept = 1024;
}  // namespace

Vector3d rotation_vector(Quaterniond q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2 * q.vec();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

[[gnu::flatten]] Quaterniond attitude_of(const Vector3d& force, double yaw) {
  const Vector3d z = force.norm() > 0 ? Vector3d(force.normalized()) : Vector3d::UnitZ();
  const Vector3d heading(std::cos(yaw), std::sin(yaw), 0);
  Vector3d y = z.cross(heading);
  if (y.norm() < kAlongHeading) y = Vector3d(-heading.y(), heading.x(), 0);
  y = (y - y.dot(z) * z).normalized();
  Matrix3d r;
  r << y.cross(z), y, z;
  return Quaterniond(r);
}

AttitudeReference planned_attitude(const ReferenceMotion& reference, double time) {
  const auto at = [&](double t) {
    const ReferencePoint point = reference.at(std::clamp(t, reference.start(), reference.finish()));
    return attitude_of(reference.force(point), point.yaw);
  };
  const Quaterniond before = at(time - kDifference), now = at(time), after = at(time + kDifference);
  const Vector3d first = rotation_vector(before.conjugate() * now) / kDifference;
  const Vector3d second = rotation_vector(now.conjugate() * after) / kDifference;
  return {now, (first + second) / 2, (second - first) / kDifference};
}

void SteppedAttitudes::divide(double step) {
  if (step == step_) return;
  step_ = step;
  apart_ = std::max<std::int64_t>(1, std::llround(kDifference / step));
  kept_.assign(kKept, {});
}

SteppedAttitudes::Kept& SteppedAttitudes::kept(std::int64_t index) {
  // Differences reach beyond both ends, where the reference rests.
  const std::int64_t slot = ((index % kKept) + kKept) % kKept;
  Kept& found = kept_[static_cast<std::size_t>(slot)];
  if (found.index == index && found.known) return found;
  const double time = std::clamp(reference_.start() + static_cast<double>(index) * step_,
                                 reference_.start(), reference_.finish());
  const ReferencePoint point = reference_.at(time);
  found = {index, true, attitude_of(reference_.force(point), point.yaw)};
  return found;
}

const Vector3d& SteppedAttitudes::turn(std::int64_t index) {
  if (const Kept& here = kept(index); here.turns) return here.turn;
  const Quaterniond before = kept(index - apart_).attitude;
  Kept& here = kept(index);  // which may have made room for the one before
  here.turn =
      rotation_vector(before.conjugate() * here.attitude) / (static_cast<double>(apart_) * step_);
  here.turns = true;
  return here.turn;
}

Vector3d SteppedAttitudes::acceleration(std::int64_t index) {
  const Vector3d first = turn(index);
  return (turn(index + apart_) - first) / (static_cast<double>(apart_) * step_);
}

Vector3d SteppedAttitudes::body_rates(double time, double step) {
  divide(step);
  const std::int64_t index = std::llround((time - reference_.start()) / step);
  const Vector3d first = turn(index);
  return (first + turn(index + apart_)) / 2;
}

Vector3d SteppedAttitudes::accelerations(double time, double step) {
  divide(step);
  const double steps = (time - reference_.start()) / step;
  const auto index = static_cast<std::int64_t>(std::floor(steps + kOnStep));
  const double past = steps - static_cast<double>(index);
  const Vector3d here = acceleration(index);
  return past <= kOnStep ? here : Vector3d(here + past * (acceleration(index + 1) - here));
}

}  // namespace lapwing
