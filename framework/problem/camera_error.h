// SPDX-License-Identifier: Apache-2.0
// What cost terms of a camera share: how far a direction is from the one wanted, and what becomes
// of formulas with directions in them where camera and target coincide.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "framework/core/dual.h"

namespace lapwing {

inline constexpr double kNearTarget = 0.1;  // m: nearer than this no camera films a target

// 1 from kNearTarget on, falling to 0 at the target as the sixth power of the distance: a formula
// that grows with its derivatives no faster than 1 / distance^4 stays twice differentiable there.
template <class T>
T near_fade(const T& squared_distance) {
  const T share = squared_distance / (kNearTarget * kNearTarget);
  if (value_of(share) >= 1.0) return T(1.0);
  return share * share * share * (10.0 + share * (-15.0 + 6.0 * share));
}

// The squared distance itself from kNearTarget on, and never less than a third of kNearTarget^2:
// for logarithms. Twice differentiable.
template <class T>
T near_squared(const T& squared_distance) {
  const T share = squared_distance / (kNearTarget * kNearTarget);
  if (value_of(share) >= 1.0) return squared_distance;
  return (kNearTarget * kNearTarget) * (1.0 / 3 + share * share * (1.0 - share / 3.0));
}

// The angle between `d` and the z axis as two numbers, along x and along y, whose squares sum to
// the square of the angle (3.7, 3.8; reading 3.4):
//
//   r = (alpha / sin alpha) (x, y) / |d|,   cos alpha = z / |d|
//
// Smooth but for the direction straight behind. There the way out is along x + y, and within
// kBehind of it the angle is read off that way alone, wrong by less than kBehind, so that no
// derivative exceeds pi / kBehind. `d` is in metres: it fades as above where it is short.
template <class T>
std::array<T, 2> angle_residual(const Eigen::Matrix<T, 3, 1>& d) {
  using std::atan2;
  using std::sqrt;
  constexpr double kBehind = 1e-2;       // rad
  constexpr double kSeries = 1e-4;       // sin^2, below which a series is exact to rounding
  constexpr double kCoincident = 1e-12;  // m^2
  constexpr double kDiagonal = 0.5 * std::numbers::sqrt2;
  const T squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
  if (value_of(squared) < kCoincident) return {T(0.0), T(0.0)};
  const T scale = 1.0 / sqrt(squared);
  const T x = d.x() * scale, y = d.y() * scale, z = d.z() * scale;
  const T across = x * x + y * y;  // sin^2
  const T fade = near_fade(squared);
  if (value_of(z) < 0 && value_of(across) < kBehind * kBehind) {
    const T along = fade * kDiagonal * (std::numbers::pi - kDiagonal * (x + y));
    return {along, along};
  }
  T ratio;
  if (value_of(z) > 0 && value_of(across) < kSeries) {
    ratio = 1.0 + across * (1.0 / 6 + across * (3.0 / 40 + across * (15.0 / 336)));
  } else {
    const T sine = sqrt(across);
    ratio = atan2(sine, z) / sine;
  }
  ratio = ratio * fade;
  return {ratio * x, ratio * y};
}

}  // namespace lapwing
