// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/dryden.h"

#include <algorithm>
#include <cmath>

namespace lapwing {

namespace {

constexpr double kFoot = 0.3048;  // m
constexpr double kLowest = 10 * kFoot, kHighest = 1000 * kFoot;
constexpr double kLeastAirspeed = 1.0;  // m/s

}  // namespace

DrydenScales dryden_scales(double height) {
  const double feet = std::clamp(height, kLowest, kHighest) / kFoot;
  const double shape = 0.177 + 0.000823 * feet;
  return {kFoot * feet / std::pow(shape, 1.2), kFoot * feet, std::pow(shape, 0.4)};
}

DrydenGust::DrydenGust(double sigma, Random random) : sigma_(sigma), random_(random) {
  if (sigma_ == 0) return;
  along_ = random_.normal();
  // Var a = 1/2, Cov(a, b) = Var b = 1/4 in time over T.
  for (Pair* pair : {&across_, &up_}) {
    const double one = random_.normal(), other = random_.normal();
    pair->a = std::sqrt(0.5) * one;
    pair->b = std::sqrt(0.125) * (one + other);
  }
}

// a' = -a + w, b' = -b + a with white noise w, in time over T.
void DrydenGust::Pair::advance(double h, Random& random) {
  const double left = std::exp(-h), gone = std::exp(-2 * h);
  double aa = -std::expm1(-2 * h) / 2, ab = 0, bb = 0;
  if (h > 0.05) {
    ab = (1 - gone * (1 + 2 * h)) / 4;
    bb = (1 - gone * (1 + 2 * h + 2 * h * h)) / 4;
  } else {  // the same to the fourth order beyond the leading one, without cancellation
    const double h2 = h * h, h3 = h2 * h;
    ab = h2 / 2 - 2 * h3 / 3 + h2 * h2 / 2 - 4 * h2 * h3 / 15 + h3 * h3 / 9;
    bb = h3 / 3 - h2 * h2 / 2 + 2 * h2 * h3 / 5 - 2 * h3 * h3 / 9 + 2 * h2 * h2 * h3 / 21;
  }
  const double first = std::sqrt(aa), second = ab / first;
  const double third = std::sqrt(std::max(0.0, bb - second * second));
  const double one = random.normal(), other = random.normal();
  b = left * (b + h * a) + second * one + third * other;
  a = left * a + first * one;
}

double DrydenGust::Pair::value() const {
  const double root = std::sqrt(3.0);
  return root * a + (1 - root) * b;
}

Eigen::Vector3d DrydenGust::next(double height, double airspeed, double step) {
  if (sigma_ == 0) return Eigen::Vector3d::Zero();
  const DrydenScales scales = dryden_scales(height);
  const double speed = std::max(airspeed, kLeastAirspeed);
  const double h = step * speed / scales.along;
  along_ = std::exp(-h) * along_ + std::sqrt(-std::expm1(-2 * h)) * random_.normal();
  across_.advance(h, random_);
  up_.advance(step * speed / scales.up, random_);
  return sigma_ * Eigen::Vector3d(along_, across_.value(), scales.up_share * up_.value());
}

}  // namespace lapwing
