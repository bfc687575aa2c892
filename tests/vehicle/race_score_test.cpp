// SPDX-License-Identifier: Apache-2.0
// What a flight by hand is worth, on courses whose gates and distances are known.
#include "framework/vehicle/race_score.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kRound = 20;   // s, of a lap
constexpr double kRadius = 10;  // m, of the circle
constexpr double kStep = 0.02;  // s

Vector3d on_circle(double time, double radius) {
  const double angle = 2 * EIGEN_PI * time / kRound;
  return {radius * std::cos(angle), radius * std::sin(angle), 2};
}

// Two laps, counter-clockwise, from the east.
Trajectory two_laps() {
  Trajectory course;
  for (int k = 0; k <= 2000; ++k) {
    Sample sample;
    sample.time = k * kStep;
    sample.position = on_circle(sample.time, kRadius);
    course.samples.push_back(sample);
  }
  return course;
}

GateTask gate(const std::string& name, double time, double half = 1) {
  GateTask made;
  made.name = name;
  made.position = on_circle(time, kRadius);
  const Vector3d chord = on_circle(time + 0.001, kRadius) - on_circle(time - 0.001, kRadius);
  made.direction = chord.normalized();
  made.up = Vector3d::UnitZ();
  made.corners = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  return made;
}

// North and south, twice, and the finish in the east.
std::vector<GateTask> gates() {
  return {gate("north", 5), gate("south", 15), gate("north", 5), gate("south", 15),
          gate("east", 20)};
}

// As the course goes, `off(time)` metres outside of it.
template <class Off>
RaceFlight flight(const Off& off) {
  RaceFlight flown;
  double sum = 0;
  for (int k = 0; k <= 2000; ++k) {
    RaceSample sample;
    sample.time = sample.progress = k * kStep;
    sample.course = on_circle(sample.time, kRadius);
    sample.state.position = on_circle(sample.time, kRadius + off(sample.time));
    sample.deviation = std::abs(off(sample.time));
    sum += sample.deviation;
    flown.samples.push_back(sample);
  }
  flown.end = RaceEnd::finished;
  flown.time = 2 * kRound;
  flown.deviation_mean = sum / 2001;
  return flown;
}

TEST(RaceScore, OfAFlightAlongTheCourseIsItsTime) {
  const RaceScore score = score_of(flight([](double) { return 0.0; }), two_laps(), gates(), 0);
  EXPECT_TRUE(score.missed.empty());
  EXPECT_DOUBLE_EQ(score.total(), 40);
}

TEST(RaceScore, AMissedGateCostsNoOther) {
  // 3 m outside in the first quarter only: past the first lap's north.
  const auto off = [](double t) { return t > 3 && t < 7 ? 3.0 : 0.0; };
  const RaceScore score = score_of(flight(off), two_laps(), gates(), 1.5, {5, 10});
  EXPECT_EQ(score.missed, std::vector<std::string>{"north"});
  EXPECT_DOUBLE_EQ(score.gates, 10);
  EXPECT_NEAR(score.straying, 5 * 3 * 4 / 40.0, 0.02);  // 5 s/m, 3 m for a tenth of the time
  EXPECT_NEAR(score.total(), 40 + 10 + 1.5 + 1.5, 0.02);
  // Both of the second lap, and the finish.
  const auto late = [](double t) { return t > 22 ? 1.5 : 0.0; };
  EXPECT_EQ(score_of(flight(late), two_laps(), gates(), 0).missed,
            (std::vector<std::string>{"north", "south", "east"}));
}

TEST(RaceScore, OnePassageIsOneGate) {
  // The same gate twice, flown through once.
  const std::vector<GateTask> twice{gate("north", 5), gate("north", 5)};
  Trajectory once = two_laps();
  once.samples.resize(1001);
  RaceFlight flown = flight([](double) { return 0.0; });
  flown.samples.resize(1001);
  EXPECT_EQ(score_of(flown, once, twice, 0).missed.size(), 1u);
}

TEST(RaceScore, PricesComeWhenTheyAreDue) {
  const auto off = [](double t) { return t > 3 && t < 7 ? 3.0 : 0.0; };
  const RaceFlight flown = flight(off);
  const std::vector<double> scores = score_over_time(flown, two_laps(), gates(), 2, {0, 10});
  const auto at = [&](double t) { return scores[static_cast<std::size_t>(t / kStep + 0.5)]; };
  EXPECT_DOUBLE_EQ(at(0), 2);
  EXPECT_NEAR(at(10), 12, 1e-9) << "the gate may still come";
  EXPECT_NEAR(at(16), 16 + 2 + 10, 1e-9) << "the next one was passed";
  EXPECT_NEAR(at(40), score_of(flown, two_laps(), gates(), 2, {0, 10}).total(), 1e-9);
}

TEST(RaceScore, ACourseEndsInThePlaneOfItsGate) {
  std::vector<GateTask> list = gates();
  const auto direction = race_limits(two_laps(), list).finish_direction;
  ASSERT_TRUE(direction.has_value());
  EXPECT_NEAR((*direction - Vector3d::UnitY()).norm(), 0, 1e-6);
  list.pop_back();
  EXPECT_FALSE(race_limits(two_laps(), list).finish_direction.has_value());
}

}  // namespace
}  // namespace lapwing
