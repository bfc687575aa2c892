// SPDX-License-Identifier: Apache-2.0
// Laws that the fastest timing of any path obeys: turned round, moved, enlarged, with other limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "framework/core/random.h"
#include "framework/trajectory/polyline.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// A smooth path of some bends, evenly spaced.
Points wandering(std::uint64_t seed) {
  Random random(seed);
  const double a = random.uniform(2, 8), b = random.uniform(1, 3), c = random.uniform(0, 6);
  Points path;
  for (int i = 0; i <= 600; ++i) {
    const double s = i / 100.0;
    path.emplace_back(a * s, a * std::sin(b * s + c), 0.5 * a * std::cos(0.7 * b * s));
  }
  return resampled(path, 0.05);
}

Points reversed(Points path) {
  std::reverse(path.begin(), path.end());
  return path;
}

TEST(FastestTimesLaws, AWayBackTakesAsLong) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Points path = wandering(seed);
    const PathLimits limits{.speed = 6, .acceleration = 3};
    EXPECT_NEAR(fastest_times(reversed(path), limits).back(), fastest_times(path, limits).back(),
                2e-3 * fastest_times(path, limits).back());
  }
}

TEST(FastestTimesLaws, NeitherPlaceNorHeadingMatters) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.8, Vector3d(0, 0, 1)).toRotationMatrix();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Points path = wandering(seed);
    Points moved;
    for (const Vector3d& p : path) moved.push_back(R * p + Vector3d(100, -70, 9));
    const MotionLimits limits{8, 3, 2, 4, 5, 3};
    EXPECT_NEAR(fastest_times(moved, limits).back(), fastest_times(path, limits).back(), 1e-6);
  }
}

// Without a limit of speed a path k times as large takes sqrt(k) times as long; k times all limits
// of speed and k^2 times those of acceleration make it k times as fast.
TEST(FastestTimesLaws, TimesScaleAsTheirUnitsDo) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Points path = wandering(seed);
    Points larger;
    for (const Vector3d& p : path) larger.push_back(4 * p);
    const PathLimits fast{.speed = 1e6, .acceleration = 3};
    EXPECT_NEAR(fastest_times(larger, fast).back(), 2 * fastest_times(path, fast).back(), 1e-6);
    const MotionLimits limits{6, 3, 2, 4, 5, 3};
    const MotionLimits twice{12, 6, 4, 16, 20, 12};
    EXPECT_NEAR(2 * fastest_times(path, twice).back(), fastest_times(path, limits).back(), 1e-6);
  }
}

// A looser limit never makes a flight longer.
TEST(FastestTimesLaws, LooserLimitsAreNoSlower) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Points path = wandering(seed);
    const MotionLimits limits{6, 3, 2, 4, 5, 3};
    const double time = fastest_times(path, limits).back();
    for (double MotionLimits::*part :
         {&MotionLimits::speed_across, &MotionLimits::climb_speed, &MotionLimits::descent_speed,
          &MotionLimits::acceleration_across, &MotionLimits::acceleration_up,
          &MotionLimits::acceleration_down}) {
      MotionLimits looser = limits, tighter = limits;
      looser.*part *= 1.5;
      tighter.*part *= 0.5;
      EXPECT_LE(fastest_times(path, looser).back(), time + 1e-9);
      EXPECT_GE(fastest_times(path, tighter).back(), time - 1e-9);
    }
  }
}

// Up and down have limits of their own: 40 m upright, in closed form (up to speed, on, to rest).
TEST(FastestTimesLaws, UprightFlightsInClosedForm) {
  const MotionLimits limits{10, 4, 2, 5, 2, 1};
  const Points up = resampled({{0, 0, 0}, {0, 0, 40}}, 0.005);
  // Upwards the speeding up is at 2 m/s^2 and the slowing down at 1: 4 m and 8 m of way.
  EXPECT_NEAR(fastest_times(up, limits).back(), 4 / 2.0 + 4 / 1.0 + (40 - 4 - 8) / 4.0, 0.02);
  // Downwards it is the other way round: 2 m and 1 m.
  EXPECT_NEAR(fastest_times(reversed(up), limits).back(), 2 / 1.0 + 2 / 2.0 + (40 - 2 - 1) / 2.0,
              0.02);
}

TEST(FastestTimesLaws, TimesRiseAndNoPieceIsTooFast) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Points path = wandering(seed);
    const std::vector<double> times = fastest_times(path, {.speed = 5, .acceleration = 2});
    ASSERT_EQ(times.size(), path.size());
    EXPECT_EQ(times.front(), 0);
    for (std::size_t i = 1; i < path.size(); ++i) {
      ASSERT_GT(times[i], times[i - 1]);
      EXPECT_LE((path[i] - path[i - 1]).norm() / (times[i] - times[i - 1]), 5 * (1 + 1e-9));
    }
  }
}

// Points that stand twice take no time, and no time becomes NaN.
TEST(FastestTimesLaws, DegeneratePathsHaveFiniteTimes) {
  const PathLimits limits{.speed = 5, .acceleration = 2};
  for (const Points& path : {Points{{0, 0, 0}}, Points{{0, 0, 0}, {0, 0, 0}},
                             Points{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}},
                             Points{{0, 0, 0}, {1e-12, 0, 0}, {1, 0, 0}}}) {
    const std::vector<double> plain = fastest_times(path, limits);
    const std::vector<double> by_direction = fastest_times(path, MotionLimits{});
    for (const auto* times : {&plain, &by_direction}) {
      ASSERT_EQ(times->size(), path.size());
      for (std::size_t i = 0; i < times->size(); ++i) {
        EXPECT_TRUE(std::isfinite((*times)[i])) << i << " of " << path.size();
        EXPECT_GE((*times)[i], i > 0 ? (*times)[i - 1] : 0);
      }
    }
  }
}

TEST(PolylineLaws, ResamplingKeepsLengthAndEnds) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Points path = wandering(seed);
    for (const double spacing : {0.3, 1.7, 1e9}) {
      const Points even = resampled(path, spacing);
      EXPECT_EQ(even.front(), path.front());
      EXPECT_EQ(even.back(), path.back());
      EXPECT_LE(length_of(even), length_of(path) + 1e-9) << "chords cut corners";
      for (std::size_t i = 1; i < even.size(); ++i)
        EXPECT_LE((even[i] - even[i - 1]).norm(), spacing + 1e-9);
    }
    EXPECT_EQ(resampled(path, 1e9).size(), 2u);
  }
}

// A mean of points lies within their box, and turning the path round turns the result round.
TEST(PolylineLaws, RoundingIsSymmetricAndStaysWithin) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Points path = wandering(seed), smooth = rounded(path, 0.4);
    ASSERT_EQ(smooth.size(), path.size());
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : path) box.extend(p);
    const Points back = reversed(rounded(reversed(path), 0.4));
    for (std::size_t i = 0; i < path.size(); ++i) {
      EXPECT_LT((smooth[i] - back[i]).norm(), 1e-9);
      EXPECT_LT(box.exteriorDistance(smooth[i]), 1e-9);
    }
    EXPECT_LT(length_of(smooth), length_of(path)) << "bends become shorter";
    EXPECT_EQ(rounded(path, 0), path);
  }
  const Points still(5, Vector3d(1, 2, 3));
  EXPECT_EQ(rounded(still, 1), still);
}

}  // namespace
}  // namespace lapwing
