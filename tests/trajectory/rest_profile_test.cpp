// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/rest_profile.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

TEST(RestProfile, EndsAtRestWhereItShouldWithinItsLimits) {
  Random random(1);
  for (int n = 0; n < 2000; ++n) {
    const RestLimits limits{random.uniform(0.1, 6), random.uniform(0.1, 5),
                            random.uniform(0.01, 0.2)};
    const double length = n % 7 == 0 ? random.uniform(0, 1e-3) : random.uniform(0, 40);
    const RestProfile profile(length, limits);
    double at = 0, speed = 0, fastest = 0, hardest = 0;
    for (int k = 0; k < profile.steps(); ++k) {
      const double a = profile.acceleration(k);
      at += speed * limits.step + a * limits.step * limits.step / 2;
      speed += a * limits.step;
      fastest = std::max(fastest, speed);
      hardest = std::max(hardest, std::abs(a));
    }
    EXPECT_NEAR(at, length, 1e-9 * (1 + length));
    EXPECT_NEAR(speed, 0, 1e-9);
    EXPECT_LE(fastest, limits.speed * (1 + 1e-9));
    EXPECT_LE(hardest, limits.acceleration * (1 + 1e-9));
    // No slower than the continuous move, but for the rounding up to whole steps.
    const double alone = 2 * std::sqrt(length * EIGEN_PI / (2 * limits.acceleration));
    const double rise = limits.speed * EIGEN_PI / (2 * limits.acceleration);
    const double quickest = alone / 2 <= rise ? alone : length / limits.speed + rise;
    EXPECT_GE(profile.seconds(), quickest - 1e-9);
    EXPECT_LE(profile.seconds(), quickest + 4 * limits.step);
  }
}

TEST(RestProfile, OfNoLengthItTakesNoTime) {
  const RestProfile profile(0, {});
  EXPECT_EQ(profile.steps(), 0);
  EXPECT_EQ(profile.acceleration(0), 0);
}

TEST(RestProfile, RefusesWhatIsNoMove) {
  EXPECT_THROW(RestProfile(-1, {}), InputError);
  EXPECT_THROW(RestProfile(std::nan(""), {}), InputError);
  EXPECT_THROW(RestProfile(1, {0, 1, 0.1}), InputError);
  EXPECT_THROW(RestProfile(1, {1, -1, 0.1}), InputError);
  EXPECT_THROW(RestProfile(1, {1, 1, 0}), InputError);
}

}  // namespace
}  // namespace lapwing
