// SPDX-License-Identifier: Apache-2.0
// Where a gimballed camera looks: yaw and pitch in the world, no roll. Camera frame: x right, y
// down, z forward. T is double or a dual number.
//
// The gimbal holds the horizon, so that the vehicle's roll and pitch do not reach the camera
// (thesis 3.5.3): its yaw in the world is the vehicle's plus the gimbal's, its pitch the gimbal's.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace lapwing {

template <class T>
struct CameraAxes {
  Eigen::Matrix<T, 3, 1> right, down, forward;  // unit vectors in the world

  // A direction of the world, (x right, y down, z forward).
  Eigen::Matrix<T, 3, 1> in_camera(const Eigen::Matrix<T, 3, 1>& d) const {
    return {right.dot(d), down.dot(d), forward.dot(d)};
  }
};

// p_1 of (3.7) as `forward`; pitch is positive up.
template <class T>
CameraAxes<T> camera_axes(const T& yaw, const T& pitch) {
  using std::cos;
  using std::sin;
  const T cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch);
  CameraAxes<T> axes;
  axes.forward = {cp * cy, cp * sy, sp};
  axes.right = {sy, -cy, T(0.0)};
  axes.down = {sp * cy, sp * sy, -cp};
  return axes;
}

}  // namespace lapwing
