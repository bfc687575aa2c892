// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/rest_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"

namespace lapwing {

// With the speed v after `rising` steps of h, the length is v h (rising + even), since both ends
// mirror each other. The sum of sin(pi (k + 1/2) / n) over n steps is 1 / sin(pi / (2 n)).
RestProfile::RestProfile(double length, const RestLimits& limits) : step_(limits.step) {
  if (!(length >= 0) || !std::isfinite(length))
    throw InputError("a move from rest to rest needs a finite length of at least 0");
  for (const double limit : {limits.speed, limits.acceleration, limits.step})
    if (!(limit > 0) || !std::isfinite(limit))
      throw InputError(
          "a move from rest to rest needs a speed, an acceleration and a step above 0");
  if (length == 0) return;
  using std::numbers::pi;
  const double h = limits.step;
  // Without time at an even speed: length = v T, v = 2 a T / pi.
  const double alone = std::sqrt(length * pi / (2 * limits.acceleration));
  const double slow = limits.speed * pi / (2 * limits.acceleration);  // s, to the largest speed
  rising_ = std::max(1, static_cast<int>(std::ceil(std::min(alone, slow) / h - 1e-9)));
  even_ = std::max(0, static_cast<int>(std::ceil(length / (limits.speed * h) - 1e-9)) - rising_);
  const double speed = length / (h * (rising_ + even_));
  peak_ = speed * std::sin(pi / (2 * rising_)) / h;
}

double RestProfile::acceleration(int k) const {
  const auto rise = [&](int at) {
    return peak_ * std::sin(std::numbers::pi * (at + 0.5) / rising_);
  };
  if (k < 0 || k >= steps()) return 0;
  if (k < rising_) return rise(k);
  if (k < rising_ + even_) return 0;
  return -rise(k - rising_ - even_);
}

}  // namespace lapwing
