// SPDX-License-Identifier: Apache-2.0
// The session against the simulated autopilot, in virtual time: flights, faults, keys.
#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "framework/core/units.h"
#include "framework/fly/flight_summary.h"
#include "framework/mavlink/vocabulary.h"
#include "tests/fly/rehearsal.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

std::string errors_of(const Rehearsal& rehearsal) {
  const FlightRecord& record = rehearsal.session().record();
  return std::to_string(record.place_worst().error) + " m, " +
         std::to_string(record.yaw_worst().error) + " rad at " +
         std::to_string(record.yaw_worst().plan_time) + " s";
}

// Never a setpoint beyond limits, never a request to arm, whatever happens.
void expect_safe(Rehearsal& rehearsal) {
  EXPECT_EQ(rehearsal.autopilot().audit().beyond(), 0u) << rehearsal.autopilot().audit().in_words();
  EXPECT_EQ(rehearsal.autopilot().arm_requests(), 0);
}

// At rest at the end, and on the path all the while.
void expect_at_rest(Rehearsal& rehearsal, double from_path = 0.5) {
  rehearsal.drain();
  expect_safe(rehearsal);
  EXPECT_LT(rehearsal.autopilot().state().velocity.norm(), 0.75);  // at most it sinks
  EXPECT_LT(rehearsal.strayed, from_path);
}

TEST(Session, FliesAPlanWithinTheToleranceOfACertificate) {
  Rehearsal rehearsal;
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::flown) << rehearsal.session().reason();
  EXPECT_TRUE(followed_within(rehearsal.session(), 0.25));
  EXPECT_LT(rehearsal.session().record().place_mean(), 0.1);
  EXPECT_NEAR(static_cast<double>(rehearsal.session().record().setpoints()), 16 / 0.02, 5);
  expect_at_rest(rehearsal, 0.3);
  const Value seen = rehearsal.autopilot().to_value();
  EXPECT_NEAR(seen.at("setpoints").at("rate").as_number(), 50, 1);
  EXPECT_LT(seen.at("setpoints").at("gap_worst").as_number(), 0.05);
  EXPECT_EQ(seen.at("mode").as_text(), "land") << "the stream ended, and nobody took over";
}

TEST(Session, FliesAsArdupilotHasIt) {
  AutopilotOptions options;
  options.ardupilot = true;
  Rehearsal rehearsal(circle_plan(), options);
  rehearsal.run();
  EXPECT_TRUE(followed_within(rehearsal.session(), 0.25)) << rehearsal.session().reason();
  EXPECT_EQ(*rehearsal.session().report().autopilot_name(), "ArduPilot");
  EXPECT_TRUE(rehearsal.has_said("switch it to GUIDED"));
  expect_safe(rehearsal);
}

TEST(Session, FliesOnTheEarth) {
  for (const HeightOf reference : {HeightOf::sea, HeightOf::ground}) {
    Plan plan = circle_plan();
    plan.geodetic_origin = GeodeticOrigin{-33.5, 151.2, 40, reference, 0};
    Rehearsal rehearsal(plan, {}, {}, FlightFrameKind::global, {square_fence(20)});
    std::set<std::uint32_t> sent;
    rehearsal.sent = [&](const mavlink::Packet& packet) { sent.insert(packet.message); };
    rehearsal.run();
    EXPECT_TRUE(followed_within(rehearsal.session(), 0.25)) << rehearsal.session().reason();
    expect_safe(rehearsal);
    EXPECT_EQ(sent.count(mavlink::kGlobalTarget), 1u);
    EXPECT_EQ(sent.count(mavlink::kLocalTarget), 0u);
    ASSERT_EQ(rehearsal.autopilot().fence().size(), 1u);
    for (const Eigen::Vector2d& corner : rehearsal.autopilot().fence()[0].corners)
      EXPECT_NEAR(corner.cwiseAbs().maxCoeff(), 20, 0.02);
    EXPECT_EQ(rehearsal.autopilot().to_value().at("fence_breaches").as_integer(), 0);
  }
}

TEST(Session, FliesFromThePlansHome) {
  for (const HeightOf reference : {HeightOf::sea, HeightOf::ground}) {
    Plan plan = circle_plan();
    plan.geodetic_origin = GeodeticOrigin{-33.5, 151.2, 4, reference, 0};
    plan.home = Home{{12, -9, 1.5}, 120, std::nullopt, {}};
    Rehearsal rehearsal(plan, {}, {}, FlightFrameKind::global);
    rehearsal.run();
    EXPECT_TRUE(followed_within(rehearsal.session(), 0.25)) << rehearsal.session().reason();
    expect_safe(rehearsal);
  }
}

// Another home than that of the plan: its limits would count from elsewhere.
TEST(Session, WaitsForTheVehiclesHomeToBeThePlans) {
  Plan plan = circle_plan();
  plan.geodetic_origin = GeodeticOrigin{-33.5, 151.2, 40, HeightOf::sea, 0};
  plan.home = Home{{0, 0, 0}, 120, std::nullopt, {}};
  Rehearsal rehearsal(plan, {}, {}, FlightFrameKind::global);
  rehearsal.received = [](mavlink::Packet& packet) {
    if (packet.message != mavlink::kHomePosition) return true;
    mavlink::Message<mavlink::kHomePosition> home(packet);
    home.set<"latitude">(home.get<"latitude">() + 2000);  // 22 m
    const auto moved = home.packet();
    packet.payload = moved.payload;
    return true;
  };
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::refused);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("home is 22.2 m from the plan's"));
}

// The same for its height: an origin whose height is above the ellipsoid, not above the sea, say.
TEST(Session, WaitsForTheHeightOfTheVehiclesHome) {
  for (const double higher : {46.0, -12.5, 9.0}) {
    Plan plan = circle_plan();
    plan.geodetic_origin = GeodeticOrigin{-33.5, 151.2, 40, HeightOf::sea, 0};
    plan.home = Home{{0, 0, 0}, 120, std::nullopt, {}};
    Rehearsal rehearsal(plan, {}, {}, FlightFrameKind::global);
    rehearsal.received = [&](mavlink::Packet& packet) {
      if (packet.message != mavlink::kHomePosition) return true;
      mavlink::Message<mavlink::kHomePosition> home(packet);
      home.set<"altitude">(home.get<"altitude">() + static_cast<std::int32_t>(1000 * higher));
      const auto moved = home.packet();
      packet.payload = moved.payload;
      return true;
    };
    rehearsal.run();
    if (std::abs(higher) < 10) {
      EXPECT_TRUE(followed_within(rehearsal.session(), 0.25)) << rehearsal.session().reason();
      continue;
    }
    EXPECT_EQ(rehearsal.session().end(), FlightEnd::refused);
    EXPECT_THAT(rehearsal.session().reason(),
                HasSubstr(higher > 0 ? "home is 46 m above the plan's" : "m below the plan's"));
  }
}

TEST(Session, TurnsTheGimbal) {
  for (const GimbalWay way : {GimbalWay::automatic, GimbalWay::manager, GimbalWay::command}) {
    SessionOptions options;
    options.gimbal = way;
    Rehearsal rehearsal(circle_plan(), {}, options);
    rehearsal.run();
    const Value seen = rehearsal.autopilot().to_value();
    EXPECT_GT(seen.at("gimbal_messages").as_integer(), way == GimbalWay::command ? 70 : 700);
    EXPECT_NEAR(seen.at("gimbal_pitch_deg").as_number(), degrees(-0.4), 0.01);
    // The camera looks ahead, west, at the end of the plan.
    EXPECT_NEAR(seen.at("gimbal_yaw_deg").as_number(), -90, 0.1);
    EXPECT_EQ(seen.at("gimbal_asked").as_integer(), 1) << "it answers";
  }
  SessionOptions none;
  none.gimbal = GimbalWay::none;
  Rehearsal rehearsal(circle_plan(), {}, none);
  rehearsal.run();
  EXPECT_EQ(rehearsal.autopilot().to_value().at("gimbal_messages").as_integer(), 0);
}

TEST(Session, LooksAtPointsOnTheEarth) {
  Plan plan = circle_plan();
  plan.trajectory.has_target = true;
  SessionOptions options;
  options.gimbal = GimbalWay::target;
  EXPECT_THROW(Rehearsal(plan, {}, options), InputError) << "the local frame has no places";
  plan.geodetic_origin = GeodeticOrigin{46, 7, 0, HeightOf::ground, 0};
  Rehearsal rehearsal(plan, {}, options, FlightFrameKind::global);
  int pointed = 0;
  rehearsal.sent = [&](const mavlink::Packet& packet) {
    if (packet.message != mavlink::kCommandInt) return;
    const mavlink::Message<mavlink::kCommandInt> m(packet);
    EXPECT_EQ(m.get<"command">(), mavlink::kDoSetRoiLocation);
    EXPECT_EQ(m.get<"x">(), 460000000) << "the target is the origin";
    EXPECT_EQ(m.get<"frame">(), mavlink::kFrameRelativeInt);
    ++pointed;
  };
  rehearsal.run();
  EXPECT_GT(pointed, 70);
  EXPECT_THROW(Rehearsal(circle_plan(), {}, options), InputError) << "a plan without targets";
}

TEST(Session, PausesAndResumesAlongThePath) {
  Rehearsal rehearsal;
  rehearsal.run_until(FlightPhase::flying);
  rehearsal.run(7);  // at the largest speed
  rehearsal.session().press(FlightKey::pause);
  rehearsal.run(6);
  EXPECT_TRUE(rehearsal.session().paused());
  EXPECT_LT(rehearsal.autopilot().state().velocity.norm(), 0.05) << "it stands";
  const double stood = rehearsal.session().plan_time();
  rehearsal.run(3);
  EXPECT_EQ(rehearsal.session().plan_time(), stood);
  EXPECT_LT(distance_from_path(circle_plan(), rehearsal.autopilot().state().position), 0.2);
  rehearsal.session().press(FlightKey::resume);
  rehearsal.run();
  EXPECT_TRUE(followed_within(rehearsal.session(), 0.25)) << errors_of(rehearsal);
  EXPECT_EQ(rehearsal.session().plan_time(), 16);
  expect_at_rest(rehearsal);
}

TEST(Session, AbortsByABrakeAndHolds) {
  Rehearsal rehearsal;
  rehearsal.run_until(FlightPhase::flying);
  rehearsal.run(8);
  rehearsal.session().press(FlightKey::abort);
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::aborted);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("by the user"));
  EXPECT_LT(rehearsal.session().plan_time(), 12);
  EXPECT_LT(distance_from_path(circle_plan(), rehearsal.autopilot().state().position), 0.2);
  expect_at_rest(rehearsal);
}

TEST(Session, AbortsAnyTime) {
  for (double at = 0; at < 25; at += 1.7) {
    Rehearsal rehearsal;
    rehearsal.run(at);
    rehearsal.session().press(FlightKey::abort);
    rehearsal.run();
    EXPECT_EQ(rehearsal.session().phase(), FlightPhase::ended);
    expect_at_rest(rehearsal);
  }
}

TEST(Session, AsksForTheModeOnRequestAndForHoldAtTheEnd) {
  for (const bool ardupilot : {false, true}) {
    AutopilotOptions autopilot;
    autopilot.ardupilot = ardupilot;
    autopilot.pilot = SimulatedPilot::arms;
    SessionOptions options;
    options.enter_mode = true;
    Rehearsal rehearsal(circle_plan(), autopilot, options);
    rehearsal.run();
    EXPECT_TRUE(followed_within(rehearsal.session(), 0.25)) << rehearsal.session().reason();
    EXPECT_EQ(rehearsal.autopilot().mode_name(), "hold");
    EXPECT_FALSE(rehearsal.autopilot().to_value().at("failsafe").as_boolean());
    expect_safe(rehearsal);
  }
}

TEST(Session, HandsTheFenceOver) {
  Rehearsal rehearsal(circle_plan(), {}, {}, FlightFrameKind::local,
                      {square_fence(20), square_fence(30)});
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().fence_items(), 8u);
  ASSERT_EQ(rehearsal.autopilot().fence().size(), 2u);
  EXPECT_TRUE(rehearsal.autopilot().fence()[0].inclusion);
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::flown);
  SessionOptions keep;
  keep.upload_fence = false;
  Rehearsal kept(circle_plan(), {}, keep, FlightFrameKind::local, {square_fence(20)});
  kept.run();
  EXPECT_TRUE(kept.autopilot().fence().empty());
  EXPECT_EQ(kept.session().end(), FlightEnd::flown);
}

// A plan that begins and ends in motion gathers way along its path, and stops at its last place.
TEST(Session, SlowsAPlanThatEndsInMotion) {
  const Plan plan = circle_plan(true);
  Rehearsal rehearsal(plan);
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::flown) << rehearsal.session().reason();
  EXPECT_NEAR(rehearsal.session().plan_time(), 16, 0.05);
  EXPECT_LT(
      (rehearsal.autopilot().state().position - plan.trajectory.samples.back().position).norm(),
      0.3);
  expect_at_rest(rehearsal);
}

struct FaultCase {
  const char* faults;
  FlightEnd end;
  const char* reason;  // a part of it
  // Where setpoints are old when they come: m, that the vehicle may be off by; 0: a certificate's.
  double late = 0;
};

class Faults : public testing::TestWithParam<FaultCase> {};

AutopilotOptions with_faults(const std::string& list) {
  AutopilotOptions options;
  std::istringstream words(list);
  for (std::string word; words >> word;) add_fault(word, options.faults);
  return options;
}

TEST_P(Faults, AreFlownOrEndSafely) {
  SessionOptions options;
  options.wait_pilot = 20;
  Rehearsal rehearsal(circle_plan(), with_faults(GetParam().faults), options,
                      FlightFrameKind::local, {square_fence(20)});
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), GetParam().end)
      << to_string(rehearsal.session().end()) << ": " << rehearsal.session().reason();
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr(GetParam().reason));
  const bool flown = GetParam().end == FlightEnd::flown;
  if (GetParam().late > 0) {
    EXPECT_LT(rehearsal.session().record().place_worst().error, GetParam().late);
    EXPECT_LT(rehearsal.session().record().yaw_worst().error, 0.35);
  } else {
    EXPECT_EQ(followed_within(rehearsal.session(), 0.25), flown)
        << rehearsal.session().record().place_worst().error;
  }
  expect_at_rest(rehearsal);
}

INSTANTIATE_TEST_SUITE_P(
    All, Faults,
    testing::Values(
        FaultCase{"lost=0.2", FlightEnd::flown, ""},
        FaultCase{"late=0.06", FlightEnd::flown, "", 0.25},
        FaultCase{"noise=0.1", FlightEnd::flown, ""},
        FaultCase{"lost=0.1 late=0.04 noise=0.05", FlightEnd::flown, "", 0.25},
        FaultCase{"jump=30@4", FlightEnd::flown, ""}, FaultCase{"jump=-20@6", FlightEnd::flown, ""},
        FaultCase{"gap=0.3@7", FlightEnd::flown, "", 0.75},
        FaultCase{"gap=5@7", FlightEnd::taken_over, "left OFFBOARD for HOLD"},
        FaultCase{"gap=60@7", FlightEnd::link_lost, "silent for 10 s"},
        FaultCase{"takeover=8", FlightEnd::taken_over, "left OFFBOARD for POSITION"},
        FaultCase{"unwell=8", FlightEnd::aborted, "estimate"},
        FaultCase{"refuse=arm", FlightEnd::refused, "did not arm within 20 s"},
        FaultCase{"refuse=mode", FlightEnd::refused, "did not come to OFFBOARD within 20 s"},
        FaultCase{"refuse=fence", FlightEnd::refused, "refuses the fence: denied"},
        FaultCase{"estimate=bad", FlightEnd::refused, "estimate of its state is not valid"},
        FaultCase{"battery=20", FlightEnd::refused, "the battery has 20 %"},
        FaultCase{"offset=12", FlightEnd::refused, "12 m from the plan's start: 12 m east"}),
    [](const auto& one) {
      std::string name;
      for (const char c : std::string(one.param.faults))
        name += std::isalnum(static_cast<unsigned char>(c)) ? std::string(1, c) : "_";
      return name;
    });

TEST(Session, SaysThatTheClockJumped) {
  Rehearsal rehearsal(circle_plan(), with_faults("jump=30@4"));
  rehearsal.run();
  EXPECT_TRUE(rehearsal.has_said("the vehicle's clock jumped by 30 s"));
  EXPECT_EQ(rehearsal.session().clock().jumps(), 1);
}

TEST(Session, RefusesAModeThatTheVehicleDenies) {
  AutopilotOptions autopilot = with_faults("refuse=mode");
  autopilot.pilot = SimulatedPilot::arms;
  SessionOptions options;
  options.enter_mode = true;
  Rehearsal rehearsal(circle_plan(), autopilot, options);
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::refused);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("refuses OFFBOARD (MAV_RESULT 2)"));
}

// Too far from what was sent, for whatever reason: it is ended.
TEST(Session, AbortsWhenTheVehicleStrays) {
  SessionOptions options;
  options.stray = 0.02;
  Rehearsal rehearsal(circle_plan(), {}, options);
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::aborted);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("m from what it was sent, more than 0.02 m"));
  expect_at_rest(rehearsal);
}

// One way is enough to brake: the vehicle's answers are lost, and it still hears setpoints.
TEST(Session, BrakesWhenItHearsNothingAndStaysPaused) {
  Rehearsal rehearsal;
  rehearsal.run_until(FlightPhase::flying);
  rehearsal.run(7);
  rehearsal.mute = true;
  rehearsal.run(5);
  EXPECT_LT(rehearsal.autopilot().state().velocity.norm(), 0.05);
  EXPECT_EQ(rehearsal.autopilot().mode_name(), "follow") << "the stream goes on";
  rehearsal.session().press(FlightKey::resume);
  EXPECT_TRUE(rehearsal.session().paused()) << "not while it is silent";
  rehearsal.mute = false;
  rehearsal.run(2);
  EXPECT_TRUE(rehearsal.has_said("heard again"));
  EXPECT_TRUE(rehearsal.session().paused());
  rehearsal.session().press(FlightKey::resume);
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::flown);
  expect_at_rest(rehearsal);
}

TEST(Session, AbortsASilentFlightWhereNobodyCanResume) {
  Rehearsal rehearsal;
  rehearsal.session().nobody_resumes();
  rehearsal.run_until(FlightPhase::flying);
  rehearsal.run(7);
  rehearsal.mute = true;
  rehearsal.run(3);
  rehearsal.mute = false;
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::aborted);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("no usable place and heading for 0.5 s"));
  expect_at_rest(rehearsal);
}

TEST(Session, SaysThatNobodyAnswers) {
  Rehearsal rehearsal;
  rehearsal.mute = true;
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::refused);
  EXPECT_THAT(rehearsal.session().reason(), HasSubstr("nobody answers"));
  SessionOptions options;
  options.system = 9;
  Rehearsal other(circle_plan(), {}, options);
  other.run();
  EXPECT_THAT(other.session().reason(), HasSubstr("no vehicle 9 answers"));
}

// Heartbeats of others, by hand.
mavlink::Packet heartbeat(std::uint8_t system, std::uint8_t autopilot, std::uint8_t type) {
  mavlink::Packet packet = mavlink::Message<mavlink::kHeartbeat>()
                               .set<"type">(type)
                               .set<"autopilot">(autopilot)
                               .set<"mavlink_version">(3)
                               .packet();
  packet.system = system, packet.component = 1;
  return packet;
}

std::string refusal(std::initializer_list<mavlink::Packet> heartbeats) {
  const Plan plan = circle_plan();
  const LiveFlight flight = live_flight_of(plan, ".");
  FlightSession session(flight, FlightFrame(plan, FlightFrameKind::local), {}, {});
  for (double now = 0; now < 60 && session.phase() != FlightPhase::ended; now += 0.02) {
    for (const mavlink::Packet& packet : heartbeats) session.receive(packet, now);
    for (const mavlink::Packet& packet : session.step(now))
      EXPECT_NE(packet.message, mavlink::kLocalTarget) << "nothing of the plan is sent";
  }
  EXPECT_EQ(session.end(), FlightEnd::refused);
  return session.reason();
}

TEST(Session, RefusesVehiclesThatItCannotFly) {
  using namespace mavlink;
  EXPECT_THAT(refusal({heartbeat(1, kPx4, 1)}), HasSubstr("no multirotor (MAV_TYPE 1)"));
  EXPECT_THAT(refusal({heartbeat(1, 5, kQuadrotor)}), HasSubstr("neither PX4 nor ArduPilot"));
  EXPECT_THAT(refusal({heartbeat(1, kPx4, kQuadrotor), heartbeat(2, kPx4, kQuadrotor)}),
              HasSubstr("two vehicles answer: 1 and 2; name one with --system"));
  EXPECT_THAT(refusal({heartbeat(1, kPx4, kQuadrotor)}), HasSubstr("does not tell where it is"));
  // Ground stations and gimbals are no vehicles.
  EXPECT_THAT(refusal({heartbeat(255, kNoAutopilot, kGroundStation)}), HasSubstr("nobody answers"));
}

}  // namespace
}  // namespace lapwing
