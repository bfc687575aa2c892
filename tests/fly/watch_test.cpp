// SPDX-License-Identifier: Apache-2.0
// What a session knows of the vehicle is fresh, and is compared with what was sent, all the while.
#include <gmock/gmock.h>

#include "framework/mavlink/vocabulary.h"
#include "tests/fly/rehearsal.h"
#include "tests/obstacles.h"

namespace lapwing {
namespace {

using mavlink::Message;
using mavlink::Packet;
using testing::HasSubstr;

bool is_place(const Packet& packet) {
  return packet.message == mavlink::kLocalPosition || packet.message == mavlink::kGlobalPosition;
}

// No setpoint is beyond limits, and the vehicle comes to rest.
void expect_safe_end(Rehearsal& rehearsal) {
  EXPECT_EQ(rehearsal.session().phase(), FlightPhase::ended);
  EXPECT_EQ(rehearsal.autopilot().audit().beyond(), 0u) << rehearsal.autopilot().audit().in_words();
}

// Moves places that the session hears by 30 m east from now on.
void shift(Packet& packet) {
  if (packet.message != mavlink::kLocalPosition) return;
  Message<mavlink::kLocalPosition> m(packet);
  m.set<"y">(m.get<"y">() + 30);
  const Packet moved = m.packet();
  packet.payload = moved.payload;
}

void make_older(Packet& packet, std::uint32_t ms) {
  Message<mavlink::kLocalPosition> m(packet);
  m.set<"time_boot_ms">(m.get<"time_boot_ms">() - ms);
  packet.payload = m.packet().payload;
}

// A few messages of a kind are heard, and then no more of it.
struct Stale {
  std::uint32_t message;
  int few;
  const char* reason;
};

class StaleData : public testing::TestWithParam<Stale> {};

TEST_P(StaleData, IsNoStartOfAFlight) {
  Rehearsal rehearsal;
  int heard = 0;
  rehearsal.received = [&](Packet& packet) {
    return packet.message != GetParam().message || heard++ < GetParam().few;
  };
  int targets = 0;
  rehearsal.sent = [&](const Packet& sent) { targets += sent.message == mavlink::kLocalTarget; };
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::refused);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr(GetParam().reason));
  EXPECT_LT(targets, 150) << "nothing was flown";
  EXPECT_EQ(rehearsal.session().record().setpoints(), 0u);
}

INSTANTIATE_TEST_SUITE_P(
    All, StaleData,
    testing::Values(Stale{mavlink::kLocalPosition, 3, "not tell its place and heading any more"},
                    Stale{mavlink::kAttitude, 3, "not tell its place and heading any more"},
                    Stale{mavlink::kEstimatorStatus, 1, "not told whether its estimate is valid"}),
    [](const auto& one) { return std::to_string(one.param.message); });

// The pilot switches the mode while the last place is old: it does not settle from there.
TEST(StaleData, IsNotStreamedWhileThePilotIsAwaited) {
  AutopilotOptions options;
  options.pilot = SimulatedPilot::arms;
  Rehearsal rehearsal(circle_plan(), options);
  rehearsal.run_until(FlightPhase::waiting);
  rehearsal.run(2);
  rehearsal.received = [](Packet& packet) { return !is_place(packet); };
  rehearsal.run(1);
  int targets = 0;
  rehearsal.sent = [&](const Packet& sent) { targets += sent.message == mavlink::kLocalTarget; };
  rehearsal.run(2);
  EXPECT_EQ(targets, 0);
  EXPECT_EQ(rehearsal.session().phase(), FlightPhase::waiting);
}

TEST(StaleData, EndsTheWayToTheStart) {
  for (const std::uint32_t message : {mavlink::kLocalPosition, mavlink::kAttitude}) {
    AutopilotOptions options;
    options.faults.offset = 0.9;
    Rehearsal rehearsal(circle_plan(), options);
    rehearsal.run_until(FlightPhase::settling);
    rehearsal.run(0.3);
    rehearsal.received = [&](Packet& packet) { return packet.message != message; };
    rehearsal.run(0.8);
    rehearsal.received = nullptr;
    rehearsal.run();
    EXPECT_EQ(rehearsal.session().end(), FlightEnd::aborted);
    EXPECT_THAT(rehearsal.session().reason(), HasSubstr("no usable place and heading for 0.5 s"));
    EXPECT_EQ(rehearsal.session().plan_time(), 0);
    expect_safe_end(rehearsal);
  }
  Rehearsal rehearsal;
  rehearsal.run_until(FlightPhase::waiting);
  rehearsal.run_until(FlightPhase::settling);
  rehearsal.received = [](Packet& packet) {
    if (!is_place(packet)) return packet.message != mavlink::kEstimatorStatus;
    // Too fast to count as settled.
    Message<mavlink::kLocalPosition> m(packet);
    m.set<"vx">(1.0f);
    packet.payload = m.packet().payload;
    return true;
  };
  rehearsal.run();
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("whether its estimate is valid"));
}

// The vehicle seems to be 30 m off. However its clock was learnt, that is seen.
void expect_seen(Rehearsal& rehearsal, std::function<bool(Packet&)> before) {
  rehearsal.received = before;
  rehearsal.run_until(FlightPhase::flying);
  ASSERT_EQ(rehearsal.session().phase(), FlightPhase::flying) << rehearsal.session().reason();
  rehearsal.run(3);
  EXPECT_GT(rehearsal.session().record().measured(), 100u);
  EXPECT_LT(rehearsal.session().record().place_worst().error, 0.25);
  rehearsal.received = [before](Packet& packet) {
    shift(packet);
    return before(packet);
  };
  rehearsal.run(0.5);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("from what it was sent, more than 1 m"));
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::aborted);
}

TEST(Stray, IsSeenWithoutTimesync) {
  Rehearsal rehearsal;
  expect_seen(rehearsal, [](Packet& packet) { return packet.message != mavlink::kTimesync; });
}

TEST(Stray, IsSeenWhereTheFirstTelemetryWasLate) {
  Rehearsal rehearsal;
  bool first = true;
  expect_seen(rehearsal, [first](Packet& packet) mutable {
    if (packet.message == mavlink::kLocalPosition && first) make_older(packet, 200), first = false;
    return packet.message != mavlink::kTimesync;
  });
}

// Its reports seem to come from the future for all of the flight: they count as those of now.
TEST(Stray, IsSeenWhereTheClockIsNotKnownWell) {
  Rehearsal rehearsal;
  expect_seen(rehearsal, [&](Packet& packet) {
    const bool flies = rehearsal.session().phase() >= FlightPhase::settling;
    if (packet.message == mavlink::kLocalPosition && !flies) make_older(packet, 200);
    return packet.message != mavlink::kTimesync;
  });
}

TEST(Stray, IsSeenWhereTheFirstTripWasSlow) {
  Rehearsal rehearsal;
  bool first = true;
  expect_seen(rehearsal, [first](Packet& packet) mutable {
    if (packet.message != mavlink::kTimesync || !first) return true;
    first = false;
    Message<mavlink::kTimesync> m(packet);
    m.set<"ts1">(m.get<"ts1">() - 380000000);  // a trip of 0.4 s
    packet.payload = m.packet().payload;
    return true;
  });
}

TEST(Stray, IsSeenOnTheWayToTheStart) {
  AutopilotOptions options;
  options.faults.offset = 0.9;
  Rehearsal rehearsal(circle_plan(), options);
  rehearsal.run_until(FlightPhase::settling);
  rehearsal.run(0.5);
  rehearsal.received = [](Packet& packet) {
    shift(packet);
    return true;
  };
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::aborted);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("from what it was sent, more than 1 m"));
  expect_safe_end(rehearsal);
}

// Places that cannot be compared with anything are none.
TEST(Stray, IsNotKnownWherePlacesAreTooOldAndCountsAsSilence) {
  Rehearsal rehearsal;
  rehearsal.run_until(FlightPhase::flying);
  rehearsal.run(3);
  rehearsal.received = [](Packet& packet) {
    if (packet.message == mavlink::kLocalPosition) make_older(packet, 8000);
    return packet.message != mavlink::kTimesync;
  };
  rehearsal.run(0.04);
  rehearsal.received = [](Packet& packet) {
    Message<mavlink::kLocalPosition> m(packet);
    if (!is_place(packet)) return true;
    m.set<"time_boot_ms">(1u);  // it hangs
    packet.payload = m.packet().payload;
    return true;
  };
  rehearsal.run(1);
  EXPECT_TRUE(rehearsal.session().paused());
}

Plan with_ball(double x, double y, double z, double radius) {
  Plan plan = circle_plan();
  plan.environment.obstacles.push_back(sphere_at("tree", {x, y, z}, radius));
  plan.environment.margin = 0.4;
  return plan;
}

TEST(Settling, IsRefusedWhereTheStraightWayIsBlocked) {
  AutopilotOptions options;
  options.faults.offset = 3;
  SessionOptions session;
  session.start_tolerance = 4;
  // The plan begins at (6, 0, 5), the vehicle stands at (9, 0, 5).
  Rehearsal blocked(with_ball(7.5, 0.5, 5, 0.3), options, session);
  blocked.run();
  EXPECT_EQ(blocked.session().end(), FlightEnd::refused);
  EXPECT_THAT(blocked.session().reason(), HasSubstr("sphere 'tree' is at 0.2 m of the way, 0.4 m"));
  EXPECT_FALSE(blocked.autopilot().followed());
  Rehearsal free(with_ball(7.5, 1.2, 5, 0.3), options, session);
  free.run();
  EXPECT_EQ(free.session().end(), FlightEnd::flown) << free.session().reason();
}

TEST(Settling, IsRefusedFromOutsideOfTheFlightZoneAndNearASubject) {
  AutopilotOptions options;
  options.faults.offset = 3;
  SessionOptions session;
  session.start_tolerance = 4;
  Plan plan = with_ball(0, 0, 5, 8.5);
  plan.environment.obstacles[0].side = Side::keep_inside;
  Rehearsal outside(plan, options, session);
  outside.run();
  EXPECT_THAT(outside.session().reason(), HasSubstr("inside of sphere 'tree' is at -0.5 m"));
  plan = circle_plan();
  Subject walker;
  walker.name = "walker";
  walker.times = {0};
  walker.positions = {{7.5, 0, 5}};
  walker.distance = 1;
  plan.environment.subjects.push_back(walker);
  Rehearsal near(plan, options, session);
  near.run();
  EXPECT_THAT(near.session().reason(), HasSubstr("subject 'walker'"));
}

TEST(Settling, IsFromAtMostFiveMetresAway) {
  SessionOptions session;
  session.start_tolerance = 5.1;
  EXPECT_THROW(Rehearsal(circle_plan(), {}, session), InputError);
}

// An abort on the way to the start ramps the velocity down, as every brake does.
TEST(Settling, IsAbortedWithinLimitsAnyTime) {
  for (double at = 0; at < 3; at += 0.1) {
    AutopilotOptions options;
    options.faults.offset = 0.9;
    Rehearsal rehearsal(circle_plan(), options);
    rehearsal.run_until(FlightPhase::settling);
    rehearsal.run(at);
    rehearsal.session().press(FlightKey::abort);
    rehearsal.run();
    EXPECT_EQ(rehearsal.session().end(), FlightEnd::aborted);
    rehearsal.drain();
    EXPECT_EQ(rehearsal.autopilot().audit().beyond(), 0u)
        << at << ": " << rehearsal.autopilot().audit().in_words();
    EXPECT_LT(rehearsal.autopilot().state().velocity.norm(), 0.75);
  }
}

// A link of 0.31 s, whose delay is learnt in flight: no setpoint jumps, at a pause neither.
TEST(Delay, ChangesNoSetpointByAStep) {
  Rehearsal rehearsal;
  bool slow = false;
  rehearsal.received = [&](Packet& packet) {
    if (packet.message != mavlink::kTimesync) return true;
    Message<mavlink::kTimesync> m(packet);
    const auto trip = static_cast<std::int64_t>(slow ? 620000000 : 900000000);
    m.set<"ts1">(m.get<"ts1">() - trip).set<"tc1">(m.get<"tc1">() - trip / 2);
    packet.payload = m.packet().payload;
    return true;
  };
  rehearsal.run_until(FlightPhase::flying);
  rehearsal.run(4);
  slow = true;
  rehearsal.run(2);
  EXPECT_NEAR(rehearsal.session().clock().delay(), 0.31, 0.03);
  rehearsal.session().press(FlightKey::pause);
  rehearsal.run(4);
  rehearsal.session().press(FlightKey::resume);
  rehearsal.run(30);
  EXPECT_EQ(rehearsal.session().end() == FlightEnd::refused, false);
  EXPECT_EQ(rehearsal.autopilot().audit().beyond(), 0u) << rehearsal.autopilot().audit().in_words();
  EXPECT_LT(rehearsal.autopilot().audit().to_value().at("jump_worst").as_number(), 0.005);
}

}  // namespace
}  // namespace lapwing
