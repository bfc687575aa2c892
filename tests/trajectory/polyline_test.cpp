// SPDX-License-Identifier: Apache-2.0
// Lengths, distances, rounding and the fastest timing, with known answers.
#include <gtest/gtest.h>

#include "framework/trajectory/polyline.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

TEST(Polyline, DistancesAreToTheNearestPlace) {
  const std::vector<Points> paths = {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}}, {{5, 5, 5}}};
  EXPECT_DOUBLE_EQ(length_of(paths[0]), 4);
  EXPECT_DOUBLE_EQ(distance_to(paths, {1, 1, 0}), 1);
  EXPECT_DOUBLE_EQ(distance_to(paths, {-3, 4, 0}), 5);
  EXPECT_DOUBLE_EQ(distance_to(paths, {5, 5, 7}), 2);
  EXPECT_TRUE(std::isinf(distance_to({}, {0, 0, 0})));
}

TEST(Polyline, ResampledPointsAreEvenAndKeepTheEnds) {
  const Points path = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 2, 0}};
  const Points even = resampled(path, 0.26);
  ASSERT_EQ(even.size(), 13u);
  EXPECT_EQ(even.front(), path.front());
  EXPECT_EQ(even.back(), path.back());
  for (const Vector3d& p : even) EXPECT_LT(distance_to({path}, p), 1e-12);
  EXPECT_LT((even[4] - Vector3d(1, 0, 0)).norm(), 1e-12);
}

TEST(Polyline, RoundingKeepsStraightsAndEnds) {
  const Points straight = resampled({{0, 0, 0}, {3, 0, 0}}, 0.01);
  const Points smooth = rounded(straight, 0.05);
  for (std::size_t i = 0; i < straight.size(); ++i)
    EXPECT_LT((smooth[i] - straight[i]).norm(), 1e-12);
  const Points corner = rounded(resampled({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 0.01), 0.05);
  EXPECT_EQ(corner.back(), Vector3d(1, 1, 0));
  // A right angle is cut by sigma / sqrt(pi) on the diagonal: the mean of |x| is sigma sqrt(2/pi).
  EXPECT_NEAR((corner[100] - Vector3d(1, 0, 0)).norm(), 0.05 / std::sqrt(EIGEN_PI), 2e-4);
}

TEST(FastestTimes, StraightFlightsSpeedUpAndSlowDown) {
  const PathLimits limits{.speed = 2, .acceleration = 1};
  // 10 m: 2 s up to 2 m/s over 2 m, 3 s over 6 m, 2 s down.
  EXPECT_NEAR(fastest_times(resampled({{0, 0, 0}, {10, 0, 0}}, 0.01), limits).back(), 7, 0.01);
  // 1 m: the limit is not reached; 2 sqrt(1/1).
  EXPECT_NEAR(fastest_times(resampled({{0, 0, 0}, {0, 0, 1}}, 0.001), limits).back(), 2, 0.01);
}

TEST(FastestTimes, CirclesAreFlownAtTheSpeedThatTheirBendAllows) {
  Points circle;
  for (int i = 0; i <= 4000; ++i) {
    const double angle = 4 * EIGEN_PI * i / 4000;
    circle.emplace_back(2 * std::cos(angle), 2 * std::sin(angle), 0);
  }
  const std::vector<double> times = fastest_times(circle, {.speed = 10, .acceleration = 2});
  const double speed = 2 * (circle[2001] - circle[1999]).norm() / 2 / (times[2001] - times[1999]);
  EXPECT_NEAR(speed, 2, 0.01);  // sqrt(2 m/s^2 * 2 m)
}

TEST(FastestTimes, TurningBackOnTheSpotIsARest) {
  const Points path = resampled({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, 0.001);
  const std::vector<double> times = fastest_times(path, {.speed = 10, .acceleration = 1});
  EXPECT_NEAR(times.back(), 4, 0.15);  // twice from rest to rest
  const double before = (path[999] - path[998]).norm() / (times[999] - times[998]);
  EXPECT_LT(before, 0.1);
}

constexpr MotionLimits kDrone{.speed_across = 8,
                              .climb_speed = 2.5,
                              .descent_speed = 2,
                              .acceleration_across = 4,
                              .acceleration_up = 3,
                              .acceleration_down = 5};

TEST(FastestTimes, EveryDirectionHasItsOwnLimits) {
  const auto along = [](const Vector3d& to) {
    return fastest_times(resampled({{0, 0, 0}, to}, 0.005), kDrone).back();
  };
  EXPECT_NEAR(along({40, 0, 0}), 5 + 8.0 / 4, 0.02);
  EXPECT_NEAR(along({0, 0, 10}), 4 + 2.5 / 2 * (1 / 3.0 + 1 / 5.0), 0.02);
  EXPECT_NEAR(along({0, 0, -10}), 5 + 1 * (1 / 3.0 + 1 / 5.0), 0.02);
  // With all limits alike it is the timing by norms, on a level path.
  const Points level = rounded(resampled({{0, 0, 0}, {8, 0, 0}, {8, 6, 0}, {0, 3, 0}}, 0.02), 0.5);
  const MotionLimits alike{5, 5, 5, 2, 2, 2};
  EXPECT_NEAR(fastest_times(level, alike).back(),
              fastest_times(level, PathLimits{.speed = 5, .acceleration = 2}).back(), 0.05);
}

TEST(FastestTimes, DifferencesOfTheTimedPathKeepTheLimits) {
  const Points path =
      rounded(resampled({{0, 0, 2}, {9, 1, 5}, {12, 9, 4}, {3, 12, 9}, {0, 0, 3}}, 0.02), 0.8);
  const std::vector<double> times = fastest_times(path, kDrone);
  double hardest = 0;
  constexpr std::size_t kApart = 12;
  for (std::size_t i = kApart; i + kApart < path.size(); ++i) {
    const double before = times[i] - times[i - kApart], after = times[i + kApart] - times[i];
    ASSERT_GT(before, 0);
    const Vector3d u = (path[i] - path[i - kApart]) / before,
                   v = (path[i + kApart] - path[i]) / after;
    const Vector3d a = 2 * (v - u) / (before + after);
    EXPECT_LE(v.head<2>().norm(), 1.01 * kDrone.speed_across);
    EXPECT_LE(v.z(), 1.01 * kDrone.climb_speed);
    EXPECT_GE(v.z(), -1.01 * kDrone.descent_speed);
    EXPECT_LE(a.head<2>().norm(), 1.1 * kDrone.acceleration_across) << i;
    EXPECT_LE(a.z(), 1.1 * kDrone.acceleration_up) << i;
    EXPECT_GE(a.z(), -1.1 * kDrone.acceleration_down) << i;
    hardest = std::max(hardest, a.head<2>().norm());
  }
  EXPECT_GT(hardest, 0.9 * kDrone.acceleration_across) << "and no slower than it must be";
}

}  // namespace
}  // namespace lapwing
