// SPDX-License-Identifier: Apache-2.0
// How long smooth legs take: against what can be worked out by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "framework/vehicle/smooth_leg.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

const SmoothLegSettings kLeg{.speed = 3, .acceleration = 2, .stray = 0.1};

TEST(SmoothLeg, AStraightWayTakesAThirdMoreThanItsLimits) {
  // 12 m at 3 m/s, and as long again as 3 m/s take at 2 m/s^2.
  const double fastest = 12.0 / 3 + 3.0 / 2;
  const Vehicle vehicle = reference_vehicle();
  EXPECT_NEAR(smooth_leg_seconds({{0, 0, 5}, {12, 0, 5}}, 0, 0, vehicle, kLeg), 4.0 / 3 * fastest,
              0.02 * fastest);
  const double corner = smooth_leg_seconds({{0, 0, 5}, {6, 0, 5}, {6, 6, 5}}, 0, 0, vehicle, kLeg);
  EXPECT_GT(corner, 4.0 / 3 * fastest + 1) << "a corner is not passed at full speed";
  const double stops = 2 * smooth_leg_seconds({{0, 0, 5}, {6, 0, 5}}, 0, 0, vehicle, kLeg);
  EXPECT_LT(corner, stops) << "but without a stop";
}

// The largest rate and acceleration of 10 u^3 - 15 u^4 + 6 u^5, by differences.
TEST(SmoothLeg, ATurnKeepsRateAndTorque) {
  const Vehicle vehicle = reference_vehicle();
  for (const double angle : {0.05, 0.6, 3.1}) {
    const double seconds = smooth_leg_seconds({{0, 0, 5}, {0, 0, 5}}, -angle, 0, vehicle, kLeg);
    const auto heading = [&](double t) {
      const double u = t / seconds;
      return angle * u * u * u * (10 - 15 * u + 6 * u * u);
    };
    double rate = 0, acceleration = 0;
    const double h = seconds / 1000;
    for (double t = h; t < seconds - h / 2; t += h) {
      rate = std::max(rate, (heading(t + h) - heading(t - h)) / (2 * h));
      acceleration = std::max(acceleration,
                              std::abs(heading(t + h) - 2 * heading(t) + heading(t - h)) / (h * h));
    }
    const double torque = vehicle.inertia.z() * acceleration;
    EXPECT_LE(rate, 0.901 * vehicle.yaw_rate_max) << angle;
    EXPECT_LE(torque, 0.901 * vehicle.yaw_torque_max()) << angle;
    EXPECT_GT(std::max(rate / vehicle.yaw_rate_max, torque / vehicle.yaw_torque_max()), 0.89)
        << "and no more time is taken than that needs: " << angle;
  }
}

TEST(SmoothLeg, TheCameraHasTimeToTilt) {
  Vehicle vehicle = reference_vehicle();
  vehicle.gimbal = GimbalLimits{.yaw_min = 0,
                                .yaw_max = 0,
                                .pitch_min = -1.6,
                                .pitch_max = 0.1,
                                .yaw_rate_max = 0,
                                .pitch_rate_max = 0.25};
  const Points nowhere = {{0, 0, 5}, {0, 0, 5}};
  EXPECT_NEAR(smooth_leg_seconds(nowhere, 0, -1, vehicle, kLeg), 1 / (0.9 * 0.25), 1e-9);
  EXPECT_EQ(smooth_leg_seconds(nowhere, 0, 0, vehicle, kLeg), 0);
}

TEST(SmoothLeg, TheTighterLimitsHold) {
  const MotionLimits limits = within({5, 2, 1, 6, 3, 0.5}, {3, 2});
  EXPECT_EQ(limits.speed_across, 3);
  EXPECT_EQ(limits.climb_speed, 2);
  EXPECT_EQ(limits.descent_speed, 1);
  EXPECT_EQ(limits.acceleration_across, 2);
  EXPECT_EQ(limits.acceleration_up, 2);
  EXPECT_EQ(limits.acceleration_down, 0.5);
}

}  // namespace
}  // namespace lapwing
