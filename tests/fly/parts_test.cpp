// SPDX-License-Identifier: Apache-2.0
// The parts of a live flight by themselves: frames, clock, pace, faults, addresses, audits.
#include <gmock/gmock.h>
#include <pty.h>
#include <unistd.h>

#include "framework/core/files.h"
#include "framework/fly/link.h"
#include "framework/fly/plan_pacer.h"
#include "framework/fly/telemetry_log.h"
#include "framework/mavlink/vocabulary.h"
#include "framework/trajectory/interpolate.h"
#include "tests/fly/rehearsal.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

TEST(FlightFrames, TurnEastNorthUpIntoNorthEastDown) {
  EXPECT_NEAR(turned_yaw(0), kPi / 2, 1e-12);  // east
  EXPECT_NEAR(turned_yaw(kPi / 2), 0, 1e-12);  // north
  EXPECT_NEAR(turned_yaw(kPi), -kPi / 2, 1e-12);
  for (const double yaw : {-3.0, -1.0, 0.3, 2.9})
    EXPECT_NEAR(turned_yaw(turned_yaw(yaw)), yaw, 1e-12);
  const Plan plan = circle_plan();
  const FlightFrame frame(plan, FlightFrameKind::local);
  Setpoint setpoint;
  setpoint.position = {1, 2, 3};
  setpoint.velocity = {4, 5, 6};
  setpoint.acceleration = {7, 8, 9};
  setpoint.yaw_rate = 0.5;
  using namespace mavlink;
  const Message<kLocalTarget> m(frame.packet(setpoint, 12.345, 1, 1));
  EXPECT_EQ(m.get<"x">(), 2);
  EXPECT_EQ(m.get<"y">(), 1);
  EXPECT_EQ(m.get<"z">(), -3);
  EXPECT_EQ(m.get<"vx">(), 5);
  EXPECT_EQ(m.get<"vz">(), -6);
  EXPECT_EQ(m.get<"afy">(), 7);
  EXPECT_EQ(m.get<"yaw_rate">(), -0.5f) << "clockwise";
  EXPECT_EQ(m.get<"type_mask">(), 0) << "nothing is left out";
  EXPECT_EQ(m.get<"time_boot_ms">(), 12345u);
  EXPECT_EQ(m.get<"coordinate_frame">(), kFrameLocalNed);
}

TEST(FlightFrames, PlacesOnTheEarthComeBack) {
  Plan plan = circle_plan();
  EXPECT_THROW(FlightFrame(plan, FlightFrameKind::global), InputError);
  plan.geodetic_origin = GeodeticOrigin{60, 10, 100, HeightOf::sea, 40};
  const FlightFrame frame(plan, FlightFrameKind::global);
  Setpoint setpoint;
  setpoint.position = {30, -40, 5};
  using namespace mavlink;
  const Message<kGlobalTarget> m(frame.packet(setpoint, 0, 1, 1));
  EXPECT_EQ(m.get<"coordinate_frame">(), kFrameGlobalInt);
  EXPECT_NEAR(m.get<"alt">(), 105, 1e-3);
  EXPECT_NEAR(m.get<"lat_int">() * 1e-7, 60 - 40 / 111412.0, 1e-6);  // m per degree at 60 north
  Message<kGlobalPosition> told;
  told.set<"lat">(m.get<"lat_int">()).set<"lon">(m.get<"lon_int">()).set<"alt">(105000);
  EXPECT_LT((frame.position_of(told) - setpoint.position).norm(), 0.02);
}

TEST(FlightFrames, HeightsAboveHomeCountFromThePlansHome) {
  Plan plan = circle_plan();
  plan.geodetic_origin = GeodeticOrigin{60, 10, 2, HeightOf::ground, 0};
  Setpoint setpoint;
  setpoint.position = {30, -40, 5};
  using namespace mavlink;
  const auto height = [&] {
    const FlightFrame frame(plan, FlightFrameKind::global);
    const Message<kGlobalTarget> m(frame.packet(setpoint, 0, 1, 1));
    EXPECT_EQ(m.get<"coordinate_frame">(), kFrameRelativeInt);
    Message<kGlobalPosition> told;
    told.set<"lat">(m.get<"lat_int">()).set<"lon">(m.get<"lon_int">());
    told.set<"relative_alt">(static_cast<std::int32_t>(std::lround(1000 * m.get<"alt">())));
    EXPECT_LT((frame.position_of(told) - setpoint.position).norm(), 0.02);
    return m.get<"alt">();
  };
  EXPECT_NEAR(height(), 7, 1e-3) << "home is on the ground of the origin";
  plan.home = Home{{-20, 10, 1.5}, std::nullopt, std::nullopt, {}};
  EXPECT_NEAR(height(), 3.5, 1e-3);
}

TEST(TelemetryLogs, AreNeverReplaced) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("lapwing_logs_" + std::to_string(getpid()));
  const std::filesystem::path path = folder / "flights" / "take-001.tlog";
  std::optional<TelemetryLog> log = TelemetryLog::begin(path);
  ASSERT_TRUE(log);
  EXPECT_FALSE(TelemetryLog::begin(path)) << "another flight that began in the same second";
  log->write(0x0102030405060708, "packet");
  log.reset();
  EXPECT_EQ(read_file(path), std::string("\1\2\3\4\5\6\7\x8packet"));
  EXPECT_FALSE(TelemetryLog::begin(path));
  EXPECT_THROW(TelemetryLog::begin(path / "under_a_file.tlog"), InputError);
  std::filesystem::remove_all(folder);
}

TEST(VehicleClocks, TakeTheMiddleOfTheQuickestRoundTrip) {
  VehicleClock clock;
  EXPECT_FALSE(clock.known());
  clock.telemetry(10.0, 100.0);
  EXPECT_NEAR(clock.vehicle_at(10), 100, 1e-9);
  clock.answered(11.0, 11.1, 101.08);  // a round trip of 0.1 s
  EXPECT_NEAR(clock.vehicle_at(11.05), 101.08, 1e-9);
  EXPECT_NEAR(clock.delay(), 0.05, 1e-9);
  clock.answered(12.0, 13.5, 102.0);  // slow: not used
  for (int i = 0; i < 1000; ++i) clock.advance(0.02);
  EXPECT_NEAR(clock.vehicle_at(11.05), 101.08, 1e-9);
  EXPECT_EQ(clock.jumps(), 0);
}

TEST(VehicleClocks, FollowSlowlyAndTakeJumpsAtOnce) {
  VehicleClock clock;
  clock.answered(0, 0.01, 50.005);
  clock.fly();
  // A clock that runs early by 0.1 s: followed by 50 millionths at most.
  clock.answered(1, 1.01, 51.105);
  EXPECT_NEAR(clock.advance(1), 1.00005, 1e-12);
  // Late: by 1000 millionths.
  clock.answered(2, 2.01, 51.8);
  EXPECT_NEAR(clock.advance(1), 0.999, 1e-12);
  clock.telemetry(3, 83);
  EXPECT_EQ(clock.jumps(), 1);
  EXPECT_NEAR(clock.last_jump(), 30, 0.2);
  EXPECT_NEAR(clock.vehicle_at(3), 83, 1e-9);
  EXPECT_NEAR(clock.advance(1), 1, 1e-3) << "a jump is no time that passed";
  // Back: seen once several messages in turn are too old to be late.
  for (int i = 0; i < 5; ++i) clock.telemetry(4 + 0.02 * i, 44 + 0.02 * i);
  EXPECT_EQ(clock.jumps(), 2);
  EXPECT_NEAR(clock.vehicle_at(5), 45, 1e-6);
}

TEST(VehicleClocks, TakeTheBestBeforeTheFlightAtOnce) {
  VehicleClock late;
  late.telemetry(10.2, 100);  // on its way for 0.2 s
  late.telemetry(10.22, 100.22);
  EXPECT_NEAR(late.vehicle_at(10.22), 100.22, 1e-9);
  VehicleClock slow;
  slow.answered(0, 0.4, 50.4);  // all of it on the way there
  EXPECT_NEAR(slow.vehicle_at(0.4), 50.6, 1e-9);
  slow.answered(1, 1.01, 51.005);
  EXPECT_NEAR(slow.vehicle_at(1), 51, 1e-9);
  EXPECT_NEAR(slow.delay(), 0.005, 1e-9);
  // In flight the pace follows slowly; what is measured is compared by the best trip at once.
  VehicleClock flying;
  flying.answered(0, 0.4, 50.4);
  flying.fly();
  flying.answered(1, 1.01, 51.005);
  EXPECT_NEAR(flying.vehicle_at(1), 51.2, 1e-9);
  EXPECT_NEAR(flying.ours_at(51), 1, 1e-9);
  EXPECT_NEAR(flying.advance(1), 0.999, 1e-12);
}

// The share of the limits that a setpoint of the pacer needs.
double acceleration_share(const Setpoint& s, const Vehicle& vehicle) {
  return std::max({s.acceleration.head<2>().norm() / vehicle.acceleration_across_max,
                   s.acceleration.z() / *vehicle.acceleration_up_max,
                   -s.acceleration.z() / *vehicle.acceleration_down_max});
}

// Brakes wherever the plan is, and goes on: within limits, in place and in its derivatives.
TEST(PlanPacers, StayOnThePathAndWithinLimits) {
  for (const bool moving : {false, true}) {
    const Plan plan = circle_plan(moving);
    Vehicle vehicle = flying_drone();
    vehicle.acceleration_across_max = moving ? 1.1 : 3.4;  // the plan takes nine tenths of it
    for (double brake_at = 0.5; brake_at < 20; brake_at += 1.3) {
      PlanPacer pacer(plan.trajectory, vehicle);
      double time = 0;
      Setpoint before = pacer.setpoint();
      bool stood = false;
      for (; time < 60 && !pacer.finished(); time += 0.02) {
        pacer.advance(0.02, time < brake_at || time > brake_at + 8);
        const Setpoint s = pacer.setpoint();
        EXPECT_LE(acceleration_share(s, vehicle), 1 + 1e-5) << time;
        const Eigen::Vector3d moved = s.position - before.position;
        EXPECT_LT((moved - 0.01 * (s.velocity + before.velocity)).norm(), 0.002) << time;
        EXPECT_LT((s.velocity - before.velocity).norm(),
                  0.02 * vehicle.acceleration_across_max + 0.01)
            << time;
        EXPECT_LT(distance_from_path(plan, s.position), 0.15);
        EXPECT_GE(s.plan_time, before.plan_time);
        stood = stood || (time > brake_at && pacer.stands());
        before = s;
      }
      EXPECT_TRUE(pacer.finished()) << brake_at;
      EXPECT_TRUE(stood || time < brake_at + 3) << brake_at;
      EXPECT_NEAR(pacer.plan_time(), 16, 0.05);
      EXPECT_EQ(pacer.setpoint().velocity.norm(), 0);
    }
  }
}

// A pause adds p' q to the acceleration of the plan. From one setpoint to the next, q changes by no
// more than the jerk allows: at the begin of the pause, in its middle and at its end.
TEST(PlanPacers, TheJerkOfAPauseIsBoundedFromBeginToEnd) {
  for (const double stated : {0.0, 2.0})
    for (const bool moving : {false, true}) {
      const Plan plan = circle_plan(moving);
      Vehicle vehicle = flying_drone();
      vehicle.acceleration_across_max = 8;  // limits of acceleration bend nothing here
      vehicle.acceleration_up_max = vehicle.acceleration_down_max = 8;
      if (stated > 0) vehicle.jerk_max = stated;
      const double jerk = stated > 0 ? 0.5 * stated : 4 / 0.4;
      int stops = 0;
      for (double brake_at = 0.5; brake_at < 9; brake_at += 0.7) {
        PlanPacer pacer(plan.trajectory, vehicle);
        double q_before = 0, speed_before = plan.trajectory.samples.front().velocity.norm();
        bool stood = false;
        const double end = plan.trajectory.samples.back().time;
        for (double time = 0; time < 60 && !pacer.finished(); time += 0.02) {
          // Pauses that are short enough to end before the vehicle stands are among them.
          pacer.advance(0.02, time < brake_at || time > brake_at + brake_at);
          const Setpoint s = pacer.setpoint();
          const Sample planned = sample_at(plan.trajectory, s.plan_time);
          const double speed = planned.velocity.norm();
          if (pacer.finished() || s.plan_time > end - 0.1 || speed < 1e-3) continue;
          const Eigen::Vector3d added = s.acceleration - planned.acceleration * s.rate * s.rate;
          const double q = added.dot(planned.velocity) / (speed * speed);
          // The other part of the change of p' q, q d|p'|, is the plan's.
          EXPECT_LE(speed_before * std::abs(q - q_before), 0.02 * jerk + 1e-9)
              << time << " " << brake_at;
          q_before = q, speed_before = speed;
          stood = stood || pacer.stands();
        }
        stops += stood;
      }
      EXPECT_GT(stops, 3);
    }
}

TEST(PlanPacers, WithoutABrakeFlyThePlanAtItsTimes) {
  const Plan plan = circle_plan();
  PlanPacer pacer(plan.trajectory, flying_drone());
  for (int i = 1; i <= 800; ++i) {
    pacer.advance(0.02, true);
    EXPECT_NEAR(pacer.plan_time(), std::min(16.0, 0.02 * i), 1e-9);
  }
  EXPECT_TRUE(pacer.finished());
}

TEST(LinkAddresses, AreReadOrRefusedWithTheForms) {
  const LinkAddress udp = link_address_from("udp:127.0.0.1:14540");
  EXPECT_EQ(udp.kind, LinkAddress::Kind::udp);
  EXPECT_EQ(udp.host, "127.0.0.1");
  EXPECT_EQ(udp.port, 14540u);
  EXPECT_TRUE(stays_here(udp));
  EXPECT_TRUE(stays_here(link_address_from("udpin:localhost:14550")));
  EXPECT_FALSE(stays_here(link_address_from("udp:192.0.2.7:14540")));
  EXPECT_FALSE(stays_here(link_address_from("udpin:0.0.0.0:14540")));
  const LinkAddress serial = link_address_from("serial:/dev/ttyACM0:57600");
  EXPECT_EQ(serial.host, "/dev/ttyACM0");
  EXPECT_EQ(serial.port, 57600u);
  EXPECT_TRUE(stays_here(serial));
  for (const char* text : {"", "udp", "udp:", "udp:host", "udp::14540", "tcp:127.0.0.1:5760",
                           "udp:127.0.0.1:", "udp:127.0.0.1:x", "udp:127.0.0.1:70000",
                           "udp:127.0.0.1:0", "udp:127.0.0.1:-1", "127.0.0.1:14540"})
    EXPECT_THROW(link_address_from(text), InputError) << text;
  EXPECT_THROW(open_link(link_address_from("serial:/dev/null:57600")), InputError);
  EXPECT_THROW(open_link(link_address_from("serial:/dev/ttyNONE:57600")), InputError);
  EXPECT_THROW(open_link(link_address_from("serial:/dev/null:57601")), InputError);
  EXPECT_THROW(open_link(link_address_from("udp:no.such.host.invalid:1")), InputError);
}

TEST(Links, OfUdpBringDatagramsAndTellThatAPortIsInUse) {
  LinkAddress here{LinkAddress::Kind::udp_listening, "127.0.0.1", 0};
  const auto vehicle = open_link(here);
  LinkAddress there{LinkAddress::Kind::udp, "127.0.0.1", vehicle->port()};
  const auto station = open_link(there);
  EXPECT_FALSE(station->receive(0.01));
  vehicle->send("nobody is known yet");
  station->send("hello");
  EXPECT_EQ(vehicle->receive(1), "hello");
  vehicle->send("here");
  EXPECT_EQ(station->receive(1), "here");
  // A stranger is not heard.
  const auto stranger = open_link(there);
  stranger->send("me");
  EXPECT_FALSE(vehicle->receive(0.05));
  here.port = vehicle->port();
  try {
    open_link(here);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("another program listens at port"));
  }
}

TEST(Links, OfSerialLinesBringBytesAndTellThatTheLineIsGone) {
  int here = -1, there = -1;
  char name[100];
  ASSERT_EQ(::openpty(&here, &there, name, nullptr, nullptr), 0);
  const auto link = open_link({LinkAddress::Kind::serial, name, 115200});
  EXPECT_EQ(link->source(), mavlink::Source::stream);
  EXPECT_FALSE(link->receive(0.01));
  // No byte is changed on its way, as a terminal would.
  const std::string bytes("\n\r\x03\xfd\x11\x13\0end", 10);
  ASSERT_EQ(::write(here, bytes.data(), bytes.size()), 10);
  EXPECT_EQ(link->receive(1), bytes);
  link->send(bytes);
  char buffer[20];
  ASSERT_EQ(::read(here, buffer, sizeof buffer), 10);
  EXPECT_EQ(std::string(buffer, 10), bytes);
  ::close(there);
  ::close(here);
  EXPECT_THROW(link->receive(1), InputError);
  EXPECT_THROW(open_link({LinkAddress::Kind::serial, "/dev/null", 115200}), InputError);
}

TEST(SimulatedFaultLists, AreReadOrRefused) {
  SimulatedFaults faults;
  add_fault("lost=0.25", faults);
  add_fault("gap=5@7", faults);
  add_fault("refuse=fence", faults);
  EXPECT_EQ(faults.lost, 0.25);
  EXPECT_EQ(faults.gap, 5);
  EXPECT_EQ(faults.gap_at, 7);
  EXPECT_TRUE(faults.refuse_fence);
  for (const char* text : {"lost", "lost=", "lost=2", "lost=-1", "lost=x", "refuse=all", "gap=1@",
                           "storm=1", "late=nan", "battery=101"})
    EXPECT_THROW(add_fault(text, faults), InputError) << text;
}

TEST(FaultyChannels, LoseDelayAndKeepTheOrder) {
  SimulatedFaults faults;
  faults.lost = 0.3, faults.late = 0.5;
  FaultyChannel channel(faults, 5);
  std::vector<int> arrived;
  for (int i = 0; i < 1000; ++i) {
    channel.push(std::string(1, static_cast<char>(i % 100)), 0.01 * i, true);
    for (const std::string& bytes : channel.pop(0.01 * i)) arrived.push_back(bytes[0]);
  }
  EXPECT_NEAR(static_cast<double>(arrived.size()), 700, 80);
  for (std::size_t i = 1; i < arrived.size(); ++i)
    EXPECT_NE(arrived[i], arrived[i - 1]) << "once each";
  channel.push("x", 20, false);
  channel.pop(30);
  EXPECT_TRUE(channel.pop(40).empty()) << "the link is closed";
}

// An audit that cannot fail would prove nothing.
TEST(SetpointAudits, SeeWhatIsBeyondLimits) {
  const Vehicle vehicle = flying_drone();
  const auto beyond = [&](auto change) {
    SetpointAudit audit(vehicle);
    Setpoint setpoint;
    audit.take(setpoint, 0, 0);
    change(setpoint);
    audit.take(setpoint, 0.02, 0.02);
    return audit.beyond();
  };
  EXPECT_EQ(beyond([](Setpoint&) {}), 0u);
  EXPECT_EQ(beyond([](Setpoint& s) { s.position.x() = 0.3; }), 1u) << "a jump";
  EXPECT_EQ(beyond([](Setpoint& s) { s.yaw = 1; }), 1u);
  EXPECT_EQ(beyond([](Setpoint& s) { s.yaw_rate = 1.6; }), 1u);
  EXPECT_EQ(beyond([](Setpoint& s) { s.acceleration.y() = 4.1; }), 1u);
  EXPECT_EQ(beyond([](Setpoint& s) { s.acceleration.z() = -3.1; }), 1u);
  // Steps of the velocity, though the places agree with them.
  for (const double step : {0.2, 1.0, 3.0, 4.9})
    EXPECT_EQ(beyond([&](Setpoint& s) { s.velocity.x() = step, s.position.x() = 0.01 * step; }), 1u)
        << step;
  EXPECT_EQ(beyond([](Setpoint& s) { s.velocity.x() = 0.07, s.position.x() = 0.0007; }), 0u);
  EXPECT_EQ(beyond([](Setpoint& s) { s.velocity.z() = 0.1; }), 1u) << "3 m/s^2 up";
  // A velocity that the places do not follow.
  EXPECT_EQ(beyond([](Setpoint& s) { s.velocity.x() = 0.05, s.position.x() = -0.06; }), 1u);
  EXPECT_EQ(beyond([](Setpoint& s) { s.velocity = {10.1, 0, 0}, s.position.x() = 0.1; }), 1u);
  EXPECT_EQ(beyond([](Setpoint& s) { s.velocity.z() = -2.1; }), 1u);
}

// A plan of rotor thrusts that spins faster than the vehicle may turn, as headings do upside down.
TEST(LiveFlights, SendSlowerHeadingsOfPlansThatSpin) {
  Plan plan = circle_plan();
  const Vehicle vehicle = flying_drone();
  plan.trajectory = {};
  plan.trajectory.motion = rotors_motion();
  plan.trajectory.inputs_held = false;
  for (int i = 0; i <= 80; ++i) {
    Sample sample;
    sample.time = 0.05 * i;
    sample.position = {0, 0, 5};
    sample.yaw_rate = 1.8;
    sample.yaw = sample.yaw_rate * sample.time;
    const double half = sample.yaw / 2, thrust = vehicle.mass * 9.80665 / 4;
    sample.columns.set("orientation", std::vector<double>{std::cos(half), 0, 0, std::sin(half)});
    sample.columns.set("body_rates", std::vector<double>{0, 0, sample.yaw_rate});
    sample.columns.set("rotor_thrusts", std::vector<double>(4, thrust));
    plan.trajectory.samples.push_back(sample);
  }
  const LiveFlight flight = live_flight_of(plan, ".");
  ASSERT_EQ(flight.said.size(), 2u);
  EXPECT_THAT(flight.said[0], HasSubstr("the plan states rotor thrusts"));
  EXPECT_THAT(flight.said[1], HasSubstr("slower ones are sent"));
  for (const Sample& sample : flight.trajectory().samples) {
    EXPECT_LE(std::abs(sample.yaw_rate), 0.61 * vehicle.yaw_rate_max);
    EXPECT_LT((sample.position - Eigen::Vector3d(0, 0, 5)).norm(), 1e-9);
  }
}

TEST(LiveFlights, SayThatALiveSubjectIsNotFollowed) {
  Plan plan = circle_plan();
  const auto configure = [&](bool live) {
    Value subject = Value::map();
    subject.set("name", "anna");
    subject.set("live", live);
    plan.configuration = Value::map();
    plan.configuration.set("subjects", Value(Value::List{subject}));
    return live_flight_of(plan, ".").said;
  };
  EXPECT_TRUE(configure(false).empty());
  const auto said = configure(true);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], testing::AllOf(HasSubstr("'anna' is live in the mission"),
                                      HasSubstr("does not follow the subject")));
}

TEST(LiveFlights, RefusePlansThatCannotBeStreamed) {
  Plan plan = circle_plan();
  plan.trajectory.samples.resize(1);
  EXPECT_THROW(live_flight_of(plan, "."), InputError);
  plan = circle_plan();
  plan.trajectory.samples[50].acceleration.x() = 9;
  EXPECT_THROW(live_flight_of(plan, "."), InputError);
  plan = circle_plan();
  Vehicle wing = flying_drone();
  wing.wing = Wing{5, 0.35, 1, -2, 4};
  plan.vehicle = to_value(wing);
  try {
    live_flight_of(plan, ".");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("has a wing"));
  }
}

}  // namespace
}  // namespace lapwing
