// SPDX-License-Identifier: Apache-2.0
// A race that is flown stick by stick is, of the logs that are left, the same race.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/vehicle/live_race.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

// Straight on for 24 m, with a gate in the middle of it and one beside it.
struct LiveRaceTest : testing::Test {
  LiveRaceTest() {
    constexpr double kStep = 0.05;
    Sample start;
    start.position = {0, 0, 3};
    PlanBuilder builder(true, start);
    for (int k = 0; k < 40; ++k) builder.add(kStep, {{2, 0, 0}});
    for (int k = 0; k < 80; ++k) builder.add(kStep, {});
    plan = builder.finish();
    GateTask gate;
    gate.direction = Eigen::Vector3d::UnitX();
    gate.up = Eigen::Vector3d::UnitZ();
    gate.corners = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    gate.name = "straight";
    gate.position = {8, 0, 3};
    gates.push_back(gate);
    gate.name = "aside";
    gate.position = {14, 9, 3};
    gates.push_back(gate);
  }
  static RacePlayer player(const std::string& name, double weight, bool by_hand = true) {
    return {{.name = name, .log = StickLog({StickSample{}}, name), .weight = weight}, by_hand};
  }
  LiveRace race(std::vector<RacePlayer> players) const {
    return LiveRace(plan.trajectory, gates, reference_vehicle(), std::move(players));
  }
  static std::string refusal(LiveRace& race, double time, std::vector<Eigen::Vector2d> sticks) {
    try {
      race.advance(time, sticks);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  Plan plan;
  std::vector<GateTask> gates;
};

TEST_F(LiveRaceTest, FlownFromTheLogsItIsTheSameToTheBit) {
  LiveRace live = race({player("a", 0.5), player("b", 1), player("rival", 0, false)});
  double time = 0, before = 0;
  for (int k = 1; !live.over(); ++k) {
    time += k % 3 == 0 ? 0.04 : 1.0 / 60;  // frames come as they like
    live.advance(time, {{0.8, 0.3 * std::sin(time)}, {0.2, -0.1}});
    ASSERT_LT(k, 2000);
    // The gates ahead cost nothing, and the score of one that is on its way only grows.
    if (live.race(0).ended()) continue;
    EXPECT_GE(live.score(0), before - 0.1);
    EXPECT_LT(live.score(0), time + 10 + 5);
    before = live.score(0);
  }
  const std::vector<RacedPilot> raced = live.finish();
  ASSERT_EQ(raced.size(), 3u);
  for (std::size_t k = 0; k < raced.size(); ++k) {
    const RacedPilot& one = raced[k];
    Pilot again = one.pilot;
    again.log = parse_stick_log(stick_log_text(one.pilot.log), "again");
    const RaceFlight flight =
        fly_race(plan.trajectory, reference_vehicle(), again, race_limits(plan.trajectory, gates));
    EXPECT_EQ(flight.end, one.flight.end);
    EXPECT_EQ(flight.time, one.flight.time);
    EXPECT_EQ(flight.deviation_mean, one.flight.deviation_mean);
    ASSERT_EQ(flight.samples.size(), one.flight.samples.size());
    EXPECT_EQ(flight.samples.back().state.position, one.flight.samples.back().state.position);
    const RaceScore score = score_of(flight, plan.trajectory, gates, 0);
    EXPECT_EQ(score.total(), one.score.total());
    EXPECT_EQ(score.missed, std::vector<std::string>{"aside"});
    EXPECT_NEAR(live.score(k), score.total(), 0.02 * score.total());
  }
  EXPECT_LT(raced[0].flight.time, raced[2].flight.time);  // forward is faster
}

// Who has ended waits for who has not, and who never moves the stick ends all the same.
TEST_F(LiveRaceTest, ItIsOverWhenAllWhoFlyByHandHaveEnded) {
  LiveRace live = race({player("quick", 1), player("slow", 1), player("rival", 0, false)});
  double time = 0;
  bool waited = false;
  while (!live.over()) {
    time += 0.1;
    live.advance(time, {{1, 0}, {-1, 0}});
    waited = waited || (live.race(0).ended() && !live.race(1).ended());
    ASSERT_LT(time, 100);
  }
  EXPECT_TRUE(waited);
  EXPECT_EQ(live.race(0).flight().end, RaceEnd::finished);
  EXPECT_NE(live.race(1).flight().end, RaceEnd::finished);  // against the course there is no end
}

TEST_F(LiveRaceTest, WhatIsNoStickFliesNothing) {
  LiveRace live = race({player("a", 0.5)});
  live.advance(0.1, {{0, 0}});
  EXPECT_THAT(refusal(live, 0.1, {{0, 0}}), HasSubstr("must rise"));
  EXPECT_THAT(refusal(live, std::nan(""), {{0, 0}}), HasSubstr("must rise"));
  EXPECT_THAT(refusal(live, 0.7, {{0, 0}}), HasSubstr("every 0.5 s"));
  EXPECT_THAT(refusal(live, 0.2, {}), HasSubstr("expected 1"));
  EXPECT_THAT(refusal(live, 0.2, {{1.5, 0}}), HasSubstr("from -1 to 1"));
  EXPECT_EQ(live.time(), 0.1);
  EXPECT_NEAR(live.race(0).time(), 0.1, 0.0021);
  EXPECT_THROW(race({player("rival", 0, false)}), InputError);
  EXPECT_THROW(race({player("a", 2)}), InputError);
}

}  // namespace
}  // namespace lapwing
