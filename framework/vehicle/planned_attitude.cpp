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
}  // namespace

Vector3d rotation_vector(Quaterniond q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2 * q.vec();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

Quaterniond attitude_of(const Vector3d& force, double yaw) {
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

}  // namespace lapwing
