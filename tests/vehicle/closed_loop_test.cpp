// SPDX-License-Identifier: Apache-2.0
// The controller and the flight under control.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/flight_controller.h"
#include "framework/vehicle/riccati.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

TEST(Riccati, DoubleIntegratorHasItsKnownGain) {
  MatrixXd a(2, 2), b(2, 1);
  a << 0, 1, 0, 0;
  b << 0, 1;
  const MatrixXd k = regulator_gain(a, b, MatrixXd::Identity(2, 2), MatrixXd::Identity(1, 1));
  EXPECT_NEAR(k(0, 0), 1, 1e-12);
  EXPECT_NEAR(k(0, 1), std::sqrt(3), 1e-12);
}

TEST(Riccati, WhatCannotBeStabilisedIsRefused) {
  MatrixXd a(2, 2), b(2, 1);
  a << 1, 0, 0, -1;  // the growing state is not driven
  b << 0, 1;
  EXPECT_THROW(regulator_gain(a, b, MatrixXd::Identity(2, 2), MatrixXd::Identity(1, 1)), Error);
}

TEST(Attitude, ThrustAndHeadingAreWhereTheyShouldBe) {
  for (const double yaw : {0.0, 1.0, 3.1, -2.0})
    for (const Vector3d& force : {Vector3d(0, 0, 1), Vector3d(3, -2, 9), Vector3d(-5, 1, 2)}) {
      const Eigen::Matrix3d r = attitude_of(force, yaw).toRotationMatrix();
      EXPECT_LT((r.col(2) - force.normalized()).norm(), 1e-12);
      EXPECT_NEAR(r.col(1).dot(Vector3d(std::cos(yaw), std::sin(yaw), 0)), 0, 1e-12);
      EXPECT_GT(r.col(0).dot(Vector3d(std::cos(yaw), std::sin(yaw), 0)), 0);
    }
}

TEST(Attitude, ThrustAlongTheHeadingIsNoAccident) {
  for (const Vector3d& force : {Vector3d(2, 0, 0), Vector3d(-2, 0, 0), Vector3d(0, 0, 0)}) {
    const Eigen::Matrix3d r = attitude_of(force, 0).toRotationMatrix();
    EXPECT_TRUE(r.allFinite());
    EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  }
}

Vehicle real_vehicle() {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.2;
  vehicle.rotors.lag = 0.04;
  return vehicle;
}

// Whatever the step and whoever asks in which order: the differences of planned_attitude, as far as
// the step divides 0.01 s.
TEST(Attitude, SteppedDerivativesAreThoseOfThePlan) {
  Vehicle vehicle = real_vehicle();
  vehicle.drag = 0;  // velocities of these samples are not those of their forces
  Trajectory waves;
  waves.motion = force_motion();
  for (int i = 0; i <= 60; ++i) {
    Sample s;
    s.time = 3 + 0.1 * i;
    s.yaw = 0.05 * i;
    s.yaw_rate = 0.5;
    s.columns.set("force", Vector3d(4 * std::sin(0.3 * i), 3 * std::cos(0.2 * i),
                                    vehicle.mass * (kGravity + std::sin(0.1 * i))));
    s.columns.set("yaw_torque", 0.0);
    waves.samples.push_back(s);
  }
  const ReferenceMotion reference(waves, vehicle);
  for (const double step : {0.001, 0.002, 0.005, 0.01}) {
    SteppedAttitudes stepped(reference);
    const auto compare = [&](std::int64_t k) {
      const double time = reference.start() + static_cast<double>(k) * step;
      const AttitudeReference planned = planned_attitude(reference, time);
      EXPECT_LT((stepped.body_rates(time, step) - planned.body_rates).norm(), 1e-8) << time;
      EXPECT_LT((stepped.accelerations(time, step) - planned.accelerations).norm(), 1e-6) << time;
      // Between steps: linear.
      const Vector3d next = planned_attitude(reference, time + step).accelerations;
      EXPECT_LT((stepped.accelerations(time + 0.3 * step, step) -
                 (0.7 * planned.accelerations + 0.3 * next))
                    .norm(),
                1e-6);
    };
    const auto last = static_cast<std::int64_t>(6 / step);
    for (std::int64_t k = 0; k < last; ++k) compare(k);
    for (const std::int64_t k : {last / 2, std::int64_t{3}, last - 1, std::int64_t{0}}) compare(k);
  }
  // Another step is another table.
  SteppedAttitudes stepped(reference);
  stepped.body_rates(4, 0.002);
  EXPECT_LT((stepped.body_rates(4, 0.005) - planned_attitude(reference, 4).body_rates).norm(),
            1e-8);
}

TEST(ClosedLoop, AKickDiesAway) {
  // A minute of even flight with one place two centimetres off. Rotors without lag as well: their
  // attitude answers fast, but not at once.
  for (const double lag : {0.0, 0.04}) {
    Vehicle vehicle = reference_vehicle();
    vehicle.rotors.lag = lag;
    Trajectory even;
    Sample s;
    s.velocity = {0.3, 0.1, 0};
    s.columns.set("force", Eigen::Vector3d(0, 0, vehicle.mass * kGravity));
    for (int i = 0; i <= 1200; ++i) {
      s.time = 0.05 * i;
      even.samples.push_back(s);
      s.position += 0.05 * s.velocity;
    }
    even.samples[20].position.y() += 0.02;
    const FlownPath path = fly(even, vehicle);
    EXPECT_LT(path.samples.back().position_error, 1e-4) << lag;
    EXPECT_LT(path.position_error_worst, 0.021) << lag;
  }
}

TEST(ClosedLoop, FollowsAPlanToTheMillimetre) {
  const Plan plan = reference_plan();
  const FlownPath path = fly(plan.trajectory, real_vehicle());
  EXPECT_FALSE(path.lost);
  EXPECT_LT(path.position_error_worst, 0.01);
  EXPECT_LT(path.yaw_error_worst, radians(0.5));
  EXPECT_EQ(path.saturated_share, 0);
  EXPECT_LT(path.position_error_mean, path.position_error_worst);
  EXPECT_NEAR(path.samples.back().time, plan.trajectory.samples.back().time, 1e-9);
}

// Integral action takes away what wind and a wrong mass do at first.
TEST(ClosedLoop, WindAndWrongMassAreOvercome) {
  Vehicle vehicle = real_vehicle();
  PlanBuilder builder(true, {}, vehicle);
  for (int i = 0; i < 150; ++i) builder.add(0.1, {});
  const Trajectory hover = builder.finish().trajectory;
  for (const FlightConditions& conditions :
       {FlightConditions{.wind_mean = 6}, FlightConditions{.mass_error = 0.1},
        FlightConditions{.mass_error = -0.1}}) {
    const FlownPath path = fly(hover, vehicle, conditions);
    EXPECT_GT(path.position_error_worst, 0.01);
    EXPECT_LT(path.position_error_worst, 0.25);
    EXPECT_LT(path.samples.back().position_error, 1e-3);
  }
}

TEST(ClosedLoop, GustsRepeatWithTheirSeedAlone) {
  const Trajectory trajectory = reference_plan().trajectory;
  const auto end = [&](std::uint64_t seed) {
    return fly(trajectory, real_vehicle(), {.wind_gust = 2, .seed = seed})
        .samples.back()
        .state.position;
  };
  EXPECT_EQ(end(1), end(1));
  EXPECT_NE(end(1), end(2));
}

TEST(ClosedLoop, AHalvedStepChangesLittle) {
  const Trajectory trajectory = reference_plan().trajectory;
  const FlownPath coarse = fly(trajectory, real_vehicle(), {.mass_error = 0.05, .step = 0.002});
  const FlownPath fine = fly(trajectory, real_vehicle(), {.mass_error = 0.05, .step = 0.001});
  EXPECT_NEAR(coarse.position_error_worst, fine.position_error_worst,
              0.03 * fine.position_error_worst);
}

TEST(ClosedLoop, ImpossibleFlightsAreLostNotLoopedFor) {
  const Drive dive{{0, 0, -20}};  // faster than falling
  PlanBuilder builder(true, {}, real_vehicle());
  for (int i = 0; i < 100; ++i) builder.add(0.1, dive);
  const FlownPath path = fly(builder.finish().trajectory, real_vehicle());
  EXPECT_TRUE(path.lost);
  EXPECT_LT(path.samples.back().time, 9);
}

TEST(ClosedLoop, RefusesWhatMakesNoSense) {
  const Trajectory trajectory = reference_plan().trajectory;
  EXPECT_THROW(fly(trajectory, reference_vehicle(), {.wind_mean = 3}), InputError);  // no drag
  EXPECT_THROW(fly(trajectory, real_vehicle(), {.wind_mean = -3}), InputError);
  EXPECT_THROW(fly(trajectory, real_vehicle(), {.mass_error = -1}), InputError);
  EXPECT_THROW(fly(trajectory, real_vehicle(), {.step = 0}), InputError);
  Trajectory path = trajectory;
  path.motion = path_motion();
  EXPECT_THROW(fly(path, real_vehicle()), InputError);
}

}  // namespace
}  // namespace lapwing
