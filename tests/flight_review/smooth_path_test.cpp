// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/smooth_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

CurveSamples sines(double noise, double rate) {
  CurveSamples samples;
  Random random(3);
  const int count = static_cast<int>(20 * rate) + 1;
  samples.values.resize(count, 1);
  for (int i = 0; i < count; ++i) {
    samples.times.push_back(i / rate);
    samples.values(i, 0) =
        3 * std::sin(0.8 * i / rate) + noise * std::sqrt(3.0) * random.uniform(-1, 1);
  }
  return samples;
}

TEST(SmoothCurve, FollowsWhatIsSmooth) {
  const SmoothCurve curve(sines(0, 20), 0, 20, 0.2);
  for (double t = 1; t < 19; t += 0.37) {
    EXPECT_NEAR(curve.at(t)[0], 3 * std::sin(0.8 * t), 1e-3);
    EXPECT_NEAR(curve.at(t, 1)[0], 2.4 * std::cos(0.8 * t), 0.01);
    EXPECT_NEAR(curve.at(t, 2)[0], -1.92 * std::sin(0.8 * t), 0.05);
  }
  EXPECT_LT(curve.residual(), 1e-3);
}

TEST(SmoothCurve, LeavesNoiseOut) {
  const SmoothCurve curve(sines(0.3, 10), 0, 20, 0.2);
  double worst = 0, acceleration = 0;
  for (double t = 2; t < 18; t += 0.1) {
    worst = std::max(worst, std::abs(curve.at(t)[0] - 3 * std::sin(0.8 * t)));
    acceleration = std::max(acceleration, std::abs(curve.at(t, 2)[0] + 1.92 * std::sin(0.8 * t)));
  }
  EXPECT_LT(worst, 0.3);
  EXPECT_LT(acceleration, 1.5);  // a difference of noisy samples would be off by 60
  EXPECT_NEAR(curve.residual(), 0.3, 0.05);
}

TEST(SmoothCurve, FewSamplesAreNotFollowedOneByOne) {
  const SmoothCurve curve(sines(0.5, 1), 0, 20, 0.5);
  double acceleration = 0;
  for (double t = 1; t < 19; t += 0.1)
    acceleration = std::max(acceleration, std::abs(curve.at(t, 2)[0]));
  EXPECT_LT(acceleration, 3.5);  // 1.92 without noise
}

TEST(SmoothCurve, ItsDerivativesBelongTogether) {
  const SmoothCurve curve(sines(0.1, 10), 0, 20, 0.25);
  for (std::size_t k = 0; k + 1 < curve.intervals(); k += 7) {
    const double t = curve.time(k), h = curve.step(), jerk = curve.at(t + 0.5 * h, 3)[0];
    const double p = curve.at(t)[0], v = curve.at(t, 1)[0], a = curve.at(t, 2)[0];
    EXPECT_NEAR(curve.at(t + h)[0], p + h * (v + h * (a / 2 + h * jerk / 6)), 1e-9);
    EXPECT_NEAR(curve.at(t + h, 1)[0], v + h * (a + h * jerk / 2), 1e-9);
    EXPECT_NEAR(curve.at(t + h, 2)[0], a + h * jerk, 1e-8);
  }
}

TEST(SmoothCurve, NeedsSamples) {
  CurveSamples few;
  few.times = {0, 1, 2};
  few.values = Eigen::MatrixXd::Zero(3, 1);
  EXPECT_THROW(SmoothCurve(few, 0, 2, 0.1), Error);
}

}  // namespace
}  // namespace lapwing
