// SPDX-License-Identifier: Apache-2.0
// Log and plan brought together: what was put on a flight comes back.
#include "framework/flight_review/flight_alignment.h"

#include <gmock/gmock.h>

#include "tests/flight_review/recorded_flight.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

FlownSeries series_of(const std::vector<RecordedState>& states, bool local = false) {
  FlownSeries series;
  series.source = "test";
  series.local = local;
  for (const RecordedState& s : states) {
    series.times.push_back(s.time);
    series.positions.push_back(s.position);
  }
  return series;
}

std::string refusal_of(const Plan& plan, const FlownSeries& series,
                       const AlignmentRequest& asked = {}) {
  try {
    align_flight(plan.trajectory, series, asked);
  } catch (const AnotherFlight& error) {
    return error.what();
  }
  return "";
}

TEST(Alignment, ClockAndOffsetComeBack) {
  const Plan plan = wave_plan();
  const Eigen::Vector3d offset(1.2, -0.8, 0.5);
  const auto states =
      recorded(ideal_flight(plan, 20, 60, 90), {.clock = 123.456, .offset = offset, .noise = 0.05});
  const FlightAlignment found = align_flight(plan.trajectory, series_of(states));
  EXPECT_NEAR(found.clock, 123.456, 0.01);
  EXPECT_LT((found.offset + offset).norm(), 0.02);
  // Between samples a straight line has two thirds of their variance.
  EXPECT_NEAR(found.residual, 0.05 * std::sqrt(3 * 2 / 3.0), 0.005);
  EXPECT_FALSE(found.stretched);
  EXPECT_FALSE(found.confounded);
  // What is said of the uncertainty is so: within four standard deviations, and no idle claim.
  EXPECT_LT(std::abs(found.clock - 123.456), 4 * found.clock_sigma + 1e-3);
  EXPECT_LT(found.clock_sigma, 0.02);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LT(std::abs(found.offset[axis] + offset[axis]), 4 * found.offset_sigma[axis] + 1e-3);
}

// A coarse receiver: what is said of the uncertainty still holds.
TEST(Alignment, ItsUncertaintyIsThatOfManyFlights) {
  const Plan plan = wave_plan();
  double squares = 0, said = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto states = recorded(ideal_flight(plan, 5), {.clock = 10, .noise = 0.5, .seed = seed});
    const FlightAlignment found = align_flight(plan.trajectory, series_of(states));
    squares += std::pow(found.clock - 10, 2) / 20;
    said += std::pow(found.clock_sigma, 2) / 20;
  }
  EXPECT_LT(std::sqrt(squares), 0.08);
  EXPECT_GT(std::sqrt(said), 0.5 * std::sqrt(squares));
  EXPECT_LT(std::sqrt(said), 2 * std::sqrt(squares));
}

TEST(Alignment, OutliersDoNotMatter) {
  const Plan plan = wave_plan();
  auto states = recorded(ideal_flight(plan, 20), {.clock = -7.5, .noise = 0.02});
  for (std::size_t i = 0; i < states.size(); i += 9)
    states[i].position += Eigen::Vector3d(8, 5, -4);
  const FlightAlignment found = align_flight(plan.trajectory, series_of(states));
  EXPECT_NEAR(found.clock, -7.5, 0.02);
  EXPECT_LT(found.offset.norm(), 0.1);
}

TEST(Alignment, StatedClockAndPositionsStand) {
  const Plan plan = wave_plan();
  const auto states = recorded(ideal_flight(plan, 20), {.clock = 10, .offset = {0.5, 0, 0}});
  const FlightAlignment found =
      align_flight(plan.trajectory, series_of(states), {.clock = 10.1, .estimate_offset = false});
  EXPECT_EQ(found.clock, 10.1);
  EXPECT_EQ(found.offset, Eigen::Vector3d::Zero().eval());
  EXPECT_GT(found.residual, 0.3);
}

TEST(Alignment, TheHeadingOfALocalFrameComesBack) {
  const Plan plan = wave_plan();
  auto states = recorded(ideal_flight(plan, 20), {.clock = 3, .noise = 0.02});
  const Eigen::AngleAxisd turn(-0.7, Eigen::Vector3d::UnitZ());
  for (RecordedState& s : states) s.position = turn * (s.position + Eigen::Vector3d(200, -50, 3));
  const FlightAlignment found =
      align_flight(plan.trajectory, series_of(states, true), {.clock = {}, .estimate_turn = true});
  EXPECT_NEAR(found.turn, 0.7, 0.002);
  EXPECT_NEAR(found.clock, 3, 0.02);
  EXPECT_LT((found.corrected(states[100].position) -
             sample_at(plan.trajectory, states[100].time - 3).position)
                .norm(),
            0.15);
}

TEST(Alignment, HalfAFlightIsEnough) {
  const Plan plan = wave_plan();
  auto states = recorded(ideal_flight(plan, 20), {.clock = 50, .offset = {0, 1, 0}, .noise = 0.02});
  std::erase_if(states, [](const RecordedState& s) { return s.time > 50 + 20; });
  const FlightAlignment found = align_flight(plan.trajectory, series_of(states));
  EXPECT_NEAR(found.clock, 50, 0.02);
  EXPECT_LT((found.offset + Eigen::Vector3d(0, 1, 0)).norm(), 0.05);
}

TEST(Alignment, ASlowerFlightIsMatchedByItsPlaces) {
  const Plan plan = wave_plan();
  auto states = ideal_flight(plan, 20, 5, 5);
  for (RecordedState& s : states) s.time = 300 + 1.4 * s.time;
  const FlightAlignment found = align_flight(plan.trajectory, series_of(states));
  EXPECT_TRUE(found.stretched);
  EXPECT_NEAR(found.clock, 300, 1);
  EXPECT_NEAR(found.end, 1.4 * 40, 1.5);
}

TEST(Alignment, AStraightFlightSaysWhatItCannotTell) {
  Plan plan = wave_plan();
  for (Sample& s : plan.trajectory.samples) {
    s.position = {2 * s.time, 0, 5};
    s.velocity = {2, 0, 0};
    s.acceleration.setZero();
  }
  std::vector<RecordedState> states = ideal_flight(plan, 20, 0, 0);
  for (RecordedState& s : states) s.position.x() += 0.4;
  const FlightAlignment found = align_flight(plan.trajectory, series_of(states));
  EXPECT_TRUE(found.confounded);
  // The log's place 2 t + 0.4 is that of the plan after clock and offset.
  EXPECT_NEAR(2 * found.clock + found.offset.x(), -0.4, 0.01);
}

// Another film of the same place: waves of other sizes, rates and phases, from take-off to landing.
std::vector<RecordedState> other_flight(std::uint64_t seed) {
  Random random(seed);
  const auto between = [&](double low, double high) {
    return low + (high - low) * random.uniform();
  };
  const double a = between(5, 15), b = between(5, 15), u = between(0.1, 0.3), v = between(0.1, 0.3),
               p = between(0, 6), q = between(0, 6), duration = between(20, 50);
  std::vector<RecordedState> states;
  for (double t = -11; t <= duration + 9; t += 0.1) {
    const double flown = std::clamp(t, 0.0, duration);
    const double up = std::clamp(std::min((t + 11) / 6, (duration + 9 - t) / 6), 0.0, 1.0);
    RecordedState s;
    s.time = t;
    s.position = {a * std::sin(u * flown + p), b * std::sin(v * flown + q), 8 * up};
    states.push_back(s);
  }
  return states;
}

TEST(Alignment, AnotherFlightOfTheSamePlaceIsRefused) {
  const Plan plan = wave_plan();
  for (std::uint64_t seed = 1; seed <= 16; ++seed)
    EXPECT_THAT(refusal_of(plan, series_of(other_flight(seed))),
                HasSubstr("the log never flew this plan"))
        << seed;
}

TEST(Alignment, APartOfTheFlightBesideThePlanIsNoOther) {
  const Plan plan = wave_plan();
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    auto states = recorded(ideal_flight(plan, 10, 10, 10),
                           {.clock = 50, .offset = {3, -6, 1}, .noise = 0.4, .seed = seed});
    const auto cut = states.begin() + static_cast<std::ptrdiff_t>(states.size() * (3 + seed) / 16);
    if (seed % 2 == 0)
      states.erase(cut, states.end());
    else
      states.erase(states.begin(), cut);
    EXPECT_EQ(refusal_of(plan, series_of(states)), "") << seed;
  }
}

TEST(Alignment, AnotherFlightIsRefused) {
  const Plan plan = wave_plan();
  auto far = ideal_flight(plan, 20);
  for (RecordedState& s : far) s.position.x() += 5000;
  EXPECT_THAT(refusal_of(plan, series_of(far)), HasSubstr("of another place"));
  std::vector<RecordedState> other;
  for (int k = 0; k < 1000; ++k) {
    RecordedState s;
    s.time = 0.1 * k;
    s.position = {30 * std::cos(0.5 * s.time), 30 * std::sin(0.5 * s.time), 40};
    other.push_back(s);
  }
  EXPECT_THAT(refusal_of(plan, series_of(other)), HasSubstr("never flew this plan"));
  const auto own = recorded(ideal_flight(plan, 20), {.clock = 10});
  EXPECT_THAT(refusal_of(plan, series_of(own), {.clock = 40}), HasSubstr("--time-offset 40"));
}

}  // namespace
}  // namespace lapwing
