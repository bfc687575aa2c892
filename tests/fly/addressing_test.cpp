// SPDX-License-Identifier: Apache-2.0
// Who is meant by a packet: the fence's answers, the gimbal's manager, setpoints for others.
#include <gmock/gmock.h>

#include "framework/core/units.h"
#include "framework/mavlink/vocabulary.h"
#include "tests/fly/rehearsal.h"

namespace lapwing {
namespace {

using namespace mavlink;
using testing::HasSubstr;

Packet mission_ack(std::uint8_t system, std::uint8_t component, std::uint8_t type) {
  return Message<kMissionAck>()
      .set<"target_system">(system)
      .set<"target_component">(component)
      .set<"type">(type)
      .set<"mission_type">(kFenceMission)
      .packet();
}

Packet mission_request(std::uint8_t system, std::uint16_t sequence) {
  return Message<kMissionRequestInt>()
      .set<"target_system">(system)
      .set<"target_component">(kComputer)
      .set<"seq">(sequence)
      .set<"mission_type">(kFenceMission)
      .packet();
}

// Answers to others, and acceptances before the last item was sent, are no acceptance.
TEST(FenceUploads, AreDoneWhenTheirOwnLastItemIsAccepted) {
  Plan plan = circle_plan();
  plan.geodetic_origin = GeodeticOrigin{46, 7, 0, HeightOf::ground, 0};
  FenceUpload upload({square_fence(20)}, FlightFrame(plan, FlightFrameKind::global));
  double now = 0;
  EXPECT_EQ(upload.step(now, 1, 1).size(), 1u);
  upload.receive(mission_ack(kOurSystem, kComputer, kMissionAccepted), now);
  EXPECT_EQ(upload.state(), FenceUpload::State::waiting) << "nothing has been sent yet";
  upload.receive(mission_request(255, 3), now);
  EXPECT_TRUE(upload.step(now, 1, 1).empty()) << "a ground station is asked";
  for (std::uint16_t i = 0; i < 4; ++i) {
    upload.receive(mission_request(kOurSystem, i), now);
    upload.receive(mission_ack(kOurSystem, kComputer, kMissionAccepted), now);
    EXPECT_EQ(upload.state(), FenceUpload::State::waiting) << i;
    EXPECT_EQ(upload.step(now, 1, 1).size(), 1u);
  }
  upload.receive(mission_ack(255, 190, kMissionAccepted), now);
  upload.receive(mission_ack(255, 190, kMissionDenied), now);
  upload.receive(mission_ack(kOurSystem, 25, kMissionAccepted), now);
  EXPECT_EQ(upload.state(), FenceUpload::State::waiting) << "those are for others";
  upload.receive(mission_ack(kOurSystem, kComputer, kMissionAccepted), now);
  EXPECT_EQ(upload.state(), FenceUpload::State::done);
}

// Yaws on both sides of north, by both ways, at the places of the plan where they are wanted.
TEST(Gimbals, TurnBothWays) {
  for (const GimbalWay way : {GimbalWay::manager, GimbalWay::command})
    for (const double side : {-0.4, 0.4}) {
      Plan plan = circle_plan();
      for (Sample& sample : plan.trajectory.samples) sample.gimbal_yaw = side;
      SessionOptions options;
      options.gimbal = way;
      Rehearsal rehearsal(plan, {}, options);
      rehearsal.run();
      // The vehicle looks west at the end, and counter-clockwise of it is south.
      EXPECT_NEAR(rehearsal.autopilot().to_value().at("gimbal_yaw_deg").as_number(),
                  -90 - degrees(side), 0.1);
    }
}

// The request for control is repeated until it is answered; a manager elsewhere is addressed.
TEST(Gimbals, AreAskedForUntilTheyAnswer) {
  SessionOptions options;
  options.gimbal = GimbalWay::manager;
  Rehearsal rehearsal(circle_plan(), {}, options);
  int asked = 0;
  rehearsal.sent = [&](const Packet& packet) {
    if (packet.message != kCommandLong) return;
    const Message<kCommandLong> m(packet);
    if (m.get<"command">() != kGimbalConfigure) return;
    ++asked;
    EXPECT_EQ(m.get<"target_component">(), 154);
  };
  bool answers = false;
  rehearsal.received = [&](Packet& packet) {
    if (packet.message == kGimbalManagerInformation) packet.component = 154;
    if (packet.message != kCommandAck) return true;
    if (Message<kCommandAck>(packet).get<"command">() != kGimbalConfigure) return true;
    if (answers) packet.component = 154;
    return true;  // else it is the autopilot that answers, and not the manager
  };
  rehearsal.run_until(FlightPhase::flying);
  rehearsal.run(5);
  EXPECT_GE(asked, 6);
  answers = true;
  rehearsal.run(1.5);
  asked = 0;
  rehearsal.run(5);
  EXPECT_EQ(asked, 0);
}

TEST(Gimbals, ThatDoNotListenAreSaid) {
  AutopilotOptions autopilot;
  autopilot.faults.refuse_gimbal = true;
  Rehearsal rehearsal(circle_plan(), autopilot);
  rehearsal.run();
  EXPECT_EQ(rehearsal.session().end(), FlightEnd::flown);
  EXPECT_TRUE(rehearsal.has_said("gimbal does not listen to us (MAV_RESULT 2)"));
  EXPECT_EQ(rehearsal.autopilot().to_value().at("gimbal_messages").as_integer(), 0);
}

// The simulated vehicle in flight, and a setpoint that somebody else sends.
struct Sent {
  Rehearsal rehearsal;
  Message<kLocalTarget> target;
  double now = 0;

  Sent() {
    rehearsal.run_until(FlightPhase::flying);
    now = rehearsal.now();
    const Eigen::Vector3d p = rehearsal.autopilot().state().position;
    target.set<"target_system">(SimulatedAutopilot::kSystem)
        .set<"target_component">(kAutopilotComponent)
        .set<"coordinate_frame">(kFrameLocalNed)
        .set<"x">(static_cast<float>(p.y()))
        .set<"y">(static_cast<float>(p.x()))
        .set<"z">(static_cast<float>(-p.z()))
        .set<"yaw">(static_cast<float>(turned_yaw(rehearsal.autopilot().state().position.x())));
  }
  std::uint64_t taken() {
    const std::uint64_t before = rehearsal.autopilot().audit().count();
    Packet packet = target.packet();
    packet.system = 245, packet.component = 191, packet.sequence = sequence++;
    rehearsal.autopilot().receive(bytes_of(packet), now);
    rehearsal.autopilot().step(now += 0.02);
    return rehearsal.autopilot().audit().count() - before;
  }
  std::int64_t number(const char* key) {
    return rehearsal.autopilot().to_value().at(key).as_integer();
  }
  std::uint8_t sequence = 0;
};

TEST(SimulatedAutopilots, LeaveOutSetpointsForOthersAndRefuseUnknownFrames) {
  Sent sent;
  EXPECT_EQ(sent.taken(), 1u);
  sent.target.set<"target_system">(7);
  EXPECT_EQ(sent.taken(), 0u);
  EXPECT_EQ(sent.number("packets_for_others"), 1);
  sent.target.set<"target_system">(0);
  EXPECT_EQ(sent.taken(), 1u) << "for all";
  sent.target.set<"coordinate_frame">(8);  // of the body
  EXPECT_EQ(sent.taken(), 0u);
  sent.target.set<"coordinate_frame">(kFrameLocalNed).set<"type_mask">(kIgnorePosition);
  EXPECT_EQ(sent.taken(), 0u);
  EXPECT_EQ(sent.number("refused_setpoints"), 2);
}

TEST(SimulatedAutopilots, HonourTheMask) {
  Sent sent;
  // Far beyond the limits, and left out.
  sent.target.set<"type_mask">(kIgnoreVelocity | kIgnoreAcceleration | kIgnoreYaw | kIgnoreYawRate)
      .set<"vx">(90.0f)
      .set<"afy">(90.0f)
      .set<"yaw">(1e6f)
      .set<"yaw_rate">(90.0f);
  EXPECT_EQ(sent.taken(), 1u);
  EXPECT_EQ(sent.rehearsal.autopilot().audit().beyond(), 0u);
  sent.target.set<"type_mask">(kIgnoreVelocity | kIgnoreYaw | kIgnoreYawRate);
  EXPECT_EQ(sent.taken(), 1u);
  EXPECT_EQ(sent.rehearsal.autopilot().audit().beyond(), 1u) << "the acceleration counts";
}

// SYS_STATUS alone: attitude is no place.
TEST(VehicleReports, NeedAPlaceForAValidEstimate) {
  VehicleReport report;
  EXPECT_FALSE(report.estimator_good(true));
  report.attitude_healthy = true;
  EXPECT_FALSE(report.estimator_good(true));
  EXPECT_FALSE(report.estimator_good(false));
  report.place_healthy = true;  // by optical flow
  EXPECT_FALSE(report.estimator_good(true));
  EXPECT_TRUE(report.estimator_good(false));
  report.earth_place_healthy = true;
  EXPECT_TRUE(report.estimator_good(true));
}

// A vehicle that does not send ESTIMATOR_STATUS is flown by its SYS_STATUS.
TEST(VehicleReports, TakeTheEstimateOfSysStatus) {
  for (const std::uint32_t healthy : {kAttitudeSystem, kAttitudeSystem | kGpsSensor}) {
    Rehearsal rehearsal;
    rehearsal.received = [&](Packet& packet) {
      if (packet.message == kSysStatus) {
        Message<kSysStatus> m(packet);
        m.set<"onboard_control_sensors_health">(healthy);
        packet.payload = m.packet().payload;
      }
      return packet.message != kEstimatorStatus;
    };
    rehearsal.run();
    EXPECT_EQ(rehearsal.session().end(),
              healthy == kAttitudeSystem ? FlightEnd::refused : FlightEnd::flown)
        << rehearsal.session().reason();
  }
}

}  // namespace
}  // namespace lapwing
