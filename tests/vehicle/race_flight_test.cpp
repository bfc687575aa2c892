// SPDX-License-Identifier: Apache-2.0
// Stick logs, and races flown by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/vehicle/race_flight.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& text) {
  try {
    parse_stick_log(text, "pilot.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(StickLog, IsLinearBetweenSamplesAndCentredAfterThem) {
  const StickLog log =
      parse_stick_log("# a comment\ntime,forward,left\r\n0.1, 0, 1\r\n0.5,1,-1\n", "pilot.csv");
  EXPECT_EQ(log.at(0), Eigen::Vector2d(0, 1));
  EXPECT_LT((log.at(0.3) - Eigen::Vector2d(0.5, 0)).norm(), 1e-12);
  EXPECT_EQ(log.at(0.5), Eigen::Vector2d(1, -1));
  EXPECT_EQ(log.at(0.51), Eigen::Vector2d(0, 0));
}

TEST(StickLog, WhatIsNoLogIsRefusedWithItsPlace) {
  const std::string head = "time,forward,left\n";
  EXPECT_THAT(refusal(""), HasSubstr("holds no sample"));
  EXPECT_THAT(refusal("0,0,0\n"), HasSubstr("pilot.csv:1: a stick log begins with"));
  EXPECT_THAT(refusal(head + "0,0\n"), HasSubstr("pilot.csv:2: expected three numbers"));
  EXPECT_THAT(refusal(head + "0,0,0,0\n"), HasSubstr("pilot.csv:2"));
  EXPECT_THAT(refusal(head + "0,0,x\n"), HasSubstr("'0,0,x'"));
  EXPECT_THAT(refusal(head + "0,nan,0\n"), HasSubstr("finite"));
  EXPECT_THAT(refusal(head + "0,0,0\n0,0,0\n"), HasSubstr("times must rise"));
  EXPECT_THAT(refusal(head + "0,0,0\n0.4,0,0\n2,0,0\n"), HasSubstr("a gap from 0.4 s to 2 s"));
  EXPECT_THAT(refusal(head + "1,0,0\n"), HasSubstr("a gap from 0 s to 1 s"));
  EXPECT_THAT(refusal(head + "0,1.5,0\n"), HasSubstr("from -1 to 1"));
}

// Straight on, half round a circle of 6 m, and back to rest.
Plan horseshoe() {
  constexpr double kStep = 0.05, kSpeed = 4, kRadius = 6;
  Sample start;
  start.position = {0, 0, 3};
  PlanBuilder builder(true, start);
  const double turn = std::numbers::pi * kRadius / kSpeed;
  const int steps = static_cast<int>(std::round(turn / kStep));
  for (int k = 0; k < 40; ++k) builder.add(kStep, {{2, 0, 0}});
  for (int k = 0; k < steps; ++k) {
    const double angle = std::numbers::pi * (k + 0.5) / steps;
    const double pull = kSpeed * std::numbers::pi / (steps * kStep);
    builder.add(kStep, {{-pull * std::sin(angle), pull * std::cos(angle), 0}});
  }
  for (int k = 0; k < 40; ++k) builder.add(kStep, {{2, 0, 0}});
  return builder.finish();
}

// The stick at (forward, left), ten times a second for a minute.
StickLog held(double forward, double left) {
  std::vector<StickSample> samples;
  for (int k = 0; k < 600; ++k) samples.push_back({0.1 * k, {forward, left}});
  return StickLog(samples, "held");
}

RaceFlight race(const StickLog& log, double weight, double speed = 1) {
  const Plan plan = horseshoe();
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.1;
  vehicle.rotors.lag = 0.03;
  return fly_race(plan.trajectory, vehicle,
                  {.name = "p", .log = log, .weight = weight, .speed = speed});
}

TEST(RaceFlight, WithoutAStickItIsThePlan) {
  const RaceFlight flight = race(held(0, 0), 0);
  ASSERT_EQ(flight.end, RaceEnd::finished);
  const double planned = horseshoe().trajectory.samples.back().time;
  EXPECT_NEAR(flight.time, planned, 0.1 * planned);
  EXPECT_LT(flight.deviation_mean, 0.1);
  EXPECT_LT(flight.deviation_worst, 0.3);
}

TEST(RaceFlight, WithWeightZeroTheStickMovesNothing) {
  const RaceFlight one = race(held(0, 0), 0), other = race(held(1, -1), 0);
  EXPECT_EQ(one.time, other.time);
  EXPECT_EQ(one.deviation_worst, other.deviation_worst);
}

TEST(RaceFlight, ForwardIsFasterAndBackIsSlower) {
  const double forward = race(held(1, 0), 0.5).time, centred = race(held(0, 0), 0.5).time,
               back = race(held(-0.5, 0), 0.5).time;
  EXPECT_LT(forward, 0.9 * centred);
  EXPECT_GT(back, 1.05 * centred);
}

// Left of the course, which turns left round (4, 6): inside.
TEST(RaceFlight, LeftCutsTheCornerAndRightGoesWide) {
  const RaceFlight cut = race(held(0, 0.8), 0.5), wide = race(held(0, -0.4), 0.5);
  ASSERT_EQ(cut.end, RaceEnd::finished);
  ASSERT_EQ(wide.end, RaceEnd::finished);
  EXPECT_LT(cut.time, wide.time);
  const auto nearest_to_gate = [](const RaceFlight& flight) {
    double nearest = 1e300;
    for (const RaceSample& sample : flight.samples)
      nearest = std::min(nearest, (sample.state.position - Eigen::Vector3d(4, 6, 3)).norm());
    return nearest;
  };
  EXPECT_LT(nearest_to_gate(cut), nearest_to_gate(wide) - 0.5);
}

TEST(RaceFlight, TheFullStickEndsAsFarAsThePilotReaches) {
  // Along a straight: 20 s at 2 m/s.
  Sample start;
  start.position = {0, 0, 3};
  start.velocity = {2, 0, 0};
  PlanBuilder builder(true, start);
  for (int k = 0; k < 200; ++k) builder.add(0.1, {});
  const Plan plan = builder.finish();
  Vehicle vehicle = reference_vehicle();
  const RaceFlight flight =
      fly_race(plan.trajectory, vehicle,
               {.name = "p", .log = held(0, 1), .weight = 1, .strength = 4, .reach = 2.5});
  double late = 0;
  for (const RaceSample& sample : flight.samples)
    if (sample.time > 8 && sample.time < 9) late = sample.state.position.y();
  EXPECT_NEAR(late, 2.5, 0.05);
}

TEST(RaceFlight, WhoLeavesTheCourseIsOut) {
  const Plan plan = horseshoe();
  const RaceFlight flight =
      fly_race(plan.trajectory, reference_vehicle(),
               {.name = "p", .log = held(0, -1), .weight = 1, .strength = 6, .reach = 30});
  EXPECT_EQ(flight.end, RaceEnd::off_course);
  EXPECT_GT(flight.deviation_worst, 6);
}

// A stick that is worth more speed than the course has.
TEST(RaceFlight, WhoOnlyBrakesDoesNotFinish) {
  const Plan plan = horseshoe();
  const RaceFlight flight =
      fly_race(plan.trajectory, reference_vehicle(),
               {.name = "p", .log = held(-1, 0), .weight = 1, .strength = 10, .reach = 8});
  EXPECT_NE(flight.end, RaceEnd::finished);
}

TEST(RaceFlight, AFasterReferenceIsFlownFaster) {
  const double slow = race(held(0, 0), 0.2, 0.8).time, fast = race(held(0, 0), 0.2, 1.2).time;
  EXPECT_NEAR(slow / fast, 1.5, 0.15);
}

TEST(RaceFlight, PilotsThatMakeNoSenseAreRefused) {
  const Plan plan = horseshoe();
  const auto refused = [&](Pilot pilot) {
    EXPECT_THROW(fly_race(plan.trajectory, reference_vehicle(), pilot), InputError);
  };
  const StickLog log = held(0, 0);
  refused({.name = "p", .log = log, .weight = 1.1});
  refused({.name = "p", .log = log, .strength = 0});
  refused({.name = "p", .log = log, .reach = -1});
  refused({.name = "p", .log = log, .speed = 0});
  refused({.name = "p", .log = log, .handicap = std::nan("")});
}

}  // namespace
}  // namespace lapwing
