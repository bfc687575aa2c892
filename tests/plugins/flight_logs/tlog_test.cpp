// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>

#include "framework/geometry/geodetic.h"
#include "tests/flight_review/telemetry_writer.h"
#include "tests/plugins/flight_logs/reader_fixture.h"

namespace lapwing {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

FlightLog read_tlog(const std::string& bytes) {
  const FlightLog log = reader_named("tlog")->read(bytes);
  EXPECT_THAT(faults_of(log), IsEmpty());
  return log;
}

TEST(Tlog, ReadsWhatWasWritten) {
  const auto states = short_flight();
  const std::string bytes = tlog_of(states);
  ASSERT_TRUE(reader_named("tlog")->recognizes(bytes));
  const FlightLog log = read_tlog(bytes);
  EXPECT_EQ(log.damage, "");
  EXPECT_EQ(log.bytes_read, bytes.size());
  EXPECT_THAT(log.remarks, IsEmpty());
  EXPECT_THAT(log.recorder, HasSubstr("PX4"));
  EXPECT_NEAR(*log.utc, kTelemetryBegin + states[0].time, 1e-6);
  EXPECT_NEAR(log.reference->latitude_deg, kWaveLatitude, 1e-7);
  EXPECT_NEAR(log.reference->altitude, kWaveHeight, 1e-3);
  EXPECT_EQ(*log.heights, HeightOf::sea);
  ASSERT_EQ(log.find("position")->size(), states.size());
  const GeodeticPoint zero = place_of(Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < states.size(); i += 5) {
    const RecordedState& s = states[i];
    EXPECT_NEAR(log.find("position")->times[i], s.time - states[0].time, 1.1e-3);
    EXPECT_LT((row_of(log, "position", i) - s.position).norm(), 1e-5);
    EXPECT_LT((row_of(log, "velocity", i) - s.velocity).norm(), 1e-5);
    EXPECT_LT((row_of(log, "body_rates", i) - s.body_rates).norm(), 1e-5);
    const Eigen::VectorXd place = row_of(log, "place", i);
    EXPECT_LT((to_local(zero, {place[0], place[1], place[2]}) - s.position).norm(), 2e-2);
    const Eigen::VectorXd q = row_of(log, "orientation", i);
    EXPECT_LT(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).angularDistance(s.orientation), 1e-5);
    EXPECT_NEAR(std::remainder(row_of(log, "yaw", i)[0] - s.yaw, 2 * M_PI), 0, 1e-4);
    EXPECT_NEAR(std::remainder(row_of(log, "camera", i)[0] - s.camera.x(), 2 * M_PI), 0, 1e-6);
    EXPECT_NEAR(row_of(log, "camera", i)[1], s.camera.y(), 1e-6);
  }
}

TEST(Tlog, ReadsBothVersionsOfTheProtocol) {
  const auto states = short_flight();
  WireSender first{.version = 1};
  std::string bytes = tlog_record(states[0].time, wire_heartbeat(first, 4, 3));
  for (const RecordedState& s : states) bytes += tlog_record(s.time, wire_local(first, s));
  const FlightLog log = read_tlog(bytes);
  EXPECT_EQ(log.damage, "");
  EXPECT_EQ(log.find("position")->size(), states.size());
  EXPECT_THAT(log.recorder, HasSubstr("ArduPilot"));
}

// A link that holds packets back for up to 0.8 s, and a file in the order of their arrival.
TEST(Tlog, LatePacketsHaveTheTimeOfTheirMeasurement) {
  const auto states = short_flight();
  const FlightLog log =
      read_tlog(tlog_of(states, [](std::size_t i) { return i == 0 ? 0 : 0.2 * (i % 5); }));
  ASSERT_EQ(log.find("position")->size(), states.size());
  for (std::size_t i = 0; i < states.size(); ++i)
    EXPECT_NEAR(log.find("position")->times[i], states[i].time - states[0].time, 1.1e-3);
}

// The vehicle starts anew in the middle: its clock is 0 again.
TEST(Tlog, AVehicleThatStartsAnewKeepsTheTimeOfTheLog) {
  auto states = short_flight();
  WireSender sender;
  std::string bytes = tlog_record(states[0].time, wire_heartbeat(sender));
  const std::size_t half = states.size() / 2;
  for (std::size_t i = 0; i < states.size(); ++i) {
    RecordedState told = states[i];
    if (i >= half) told.time -= states[half].time;
    bytes += tlog_record(states[i].time, wire_local(sender, told));
  }
  const FlightLog log = read_tlog(bytes);
  ASSERT_EQ(log.find("position")->size(), states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    EXPECT_NEAR(log.find("position")->times[i], states[i].time - states[0].time, 2.1e-3);
    EXPECT_LT((row_of(log, "position", i) - states[i].position).norm(), 1e-5);
  }
}

// Beside the vehicle: a ground station, another vehicle that is heard later, a packet of a message
// that nobody knows, and a sequence with a gap.
TEST(Tlog, ReadsTheVehicleOfSeveralSenders) {
  auto states = short_flight();
  WireSender station{.system = 255, .component = 190}, one{.system = 3}, two{.system = 2};
  // One after the other: each packet counts up the sequence of its sender.
  std::string bytes = tlog_record(states[0].time, wire_heartbeat(station, 0, 8, 6));
  bytes += tlog_record(states[0].time, wire_heartbeat(one));
  bytes += tlog_record(states[0].time, wire_heartbeat(two));
  bytes += tlog_record(states[0].time, wire_packet(40000, 7, "abc", one));
  for (const RecordedState& s : states) {
    bytes += tlog_record(s.time, wire_local(one, s));
    RecordedState other = s;
    other.position.x() += 50;
    bytes += tlog_record(s.time, wire_local(two, other));
  }
  one.sequence = static_cast<std::uint8_t>(one.sequence + 4);
  bytes += tlog_record(states.back().time, wire_heartbeat(one));
  const FlightLog log = read_tlog(bytes);
  EXPECT_EQ(log.damage, "");
  EXPECT_THAT(log.recorder, HasSubstr("system 3"));
  EXPECT_LT((row_of(log, "position", 3) - states[3].position).norm(), 1e-5);
  EXPECT_THAT(log.remarks, Contains("1 other sender told of a motion; system 3 is read"));
  EXPECT_THAT(log.remarks, Contains("4 packets of the vehicle missing, by their sequence"));
  EXPECT_THAT(log.remarks, Contains(HasSubstr("1 packet of messages that are not known here")));
}

std::string local_target(WireSender& sender, std::uint8_t target, std::uint16_t mask, double time,
                         std::uint8_t frame = 1) {
  std::string body;
  put(body, boot_ms(time));
  put_floats(body, {1, 2, -3, 0.1, 0.2, -0.3, 0, 0, 0, M_PI / 2, 0});
  put(body, mask);
  for (const std::uint8_t byte : {target, std::uint8_t{1}, frame}) put(body, byte);
  return wire_packet(84, 143, body, sender);
}

std::string global_target(WireSender& sender, const Eigen::Vector3d& p, double time) {
  const GeodeticPoint point = place_of(p);
  std::string body;
  put(body, boot_ms(time));
  put(body, wire_degrees(point.latitude_deg));
  put(body, wire_degrees(point.longitude_deg));
  put_floats(body, {point.altitude - kWaveHeight, 0, 0, 0, 0, 0, 0, 0, 0});
  put(body, std::uint16_t{0});
  for (const std::uint8_t byte : {1, 1, 6}) put(body, byte);  // heights above home
  return wire_packet(86, 5, body, sender);
}

TEST(Tlog, SetpointsAreThoseForTheVehicle) {
  const auto states = short_flight();
  const double time = states[0].time;
  WireSender us{.system = 245, .component = 191};
  const std::string bytes =
      tlog_of(states) + tlog_record(time + 1, local_target(us, 1, 0, time + 1.02)) +
      tlog_record(time + 2, local_target(us, 1, 7 | 56, 3)) +    // a yaw alone, of another clock
      tlog_record(time + 2.1, local_target(us, 9, 0, time)) +    // for another vehicle
      tlog_record(time + 2.2, local_target(us, 1, 0, time, 8));  // in the body
  const FlightLog log = read_tlog(bytes);
  ASSERT_EQ(log.find("position_setpoint")->size(), 1u);
  EXPECT_NEAR(log.find("position_setpoint")->times[0], 1.02, 2e-3);
  EXPECT_LT((row_of(log, "position_setpoint", 0) - Eigen::Vector3d(2, 1, 3)).norm(), 1e-6);
  EXPECT_LT((row_of(log, "velocity_setpoint", 0) - Eigen::Vector3d(0.2, 0.1, 0.3)).norm(), 1e-6);
  ASSERT_EQ(log.find("yaw_setpoint")->size(), 2u);
  EXPECT_NEAR(log.find("yaw_setpoint")->times[1], 2, 1e-6);
  EXPECT_NEAR(row_of(log, "yaw_setpoint", 0)[0], 0, 1e-6);
  EXPECT_THAT(log.remarks, Contains(HasSubstr("1 setpoint in a frame that turns")));
}

// Setpoints above home make all heights of the log those above home.
TEST(Tlog, HeightsCountAsTheSetpointsCountThem) {
  const auto states = short_flight();
  WireSender us{.system = 245};
  const FlightLog log =
      read_tlog(tlog_of(states) +
                tlog_record(states[0].time + 1, global_target(us, {4, 5, 6}, states[0].time + 1)));
  EXPECT_EQ(*log.heights, HeightOf::ground);
  EXPECT_NEAR(row_of(log, "place", 0)[2], place_of(states[0].position).altitude - kWaveHeight,
              1e-3);
  EXPECT_NEAR(log.reference->altitude, 0, 2e-3);
  EXPECT_LT((row_of(log, "position_setpoint", 0) - Eigen::Vector3d(4, 5, 6)).norm(), 2e-2);
}

TEST(Tlog, BatteryTextsAndModes) {
  const auto states = short_flight();
  const double time = states[0].time;
  WireSender sender{.sequence = static_cast<std::uint8_t>(2 + 4 * states.size())};
  std::string battery(12, '\0'), text("\x04", 1), more("\x04", 1);
  put(battery, std::uint16_t{500});
  put(battery, std::uint16_t{14800});
  put(battery, std::int16_t{950});
  battery += std::string(12, '\0');
  put(battery, std::int8_t{75});
  text += padded_text("a text that is longer than fifty characters and so ", 50);
  more += padded_text("has a second part", 50);
  for (std::string* part : {&text, &more}) put(*part, std::uint16_t{7});
  put(text, std::uint8_t{0});
  put(more, std::uint8_t{1});
  const FlightLog log =
      read_tlog(tlog_of(states) + tlog_record(time + 1, wire_packet(1, 124, battery, sender)) +
                tlog_record(time + 2, wire_packet(253, 83, text, sender)) +
                tlog_record(time + 2, wire_packet(253, 83, more, sender)) +
                tlog_record(time + 3, wire_heartbeat(sender, 9)));
  EXPECT_LT((row_of(log, "battery", 0) - Eigen::Vector3d(14.8, 9.5, 0.75)).norm(), 1e-9);
  std::vector<std::string> said;
  for (const LogMessage& message : log.messages) said.push_back(message.text);
  EXPECT_THAT(said,
              testing::ElementsAre(
                  "mode 4", "armed",
                  "a text that is longer than fifty characters and sohas a second part", "mode 9"));
}

TEST(Tlog, ASilenceIsAGap) {
  auto states = short_flight();
  const std::size_t half = states.size() / 2;
  for (std::size_t i = half; i < states.size(); ++i) states[i].time += 5;
  const FlightLog log = read_tlog(tlog_of(states));
  ASSERT_EQ(log.gaps.size(), 1u);
  EXPECT_NEAR(log.gaps[0].duration, states[half].time - states[half - 1].time, 2e-3);
}

TEST(Tlog, BytesBetweenRecordsAreSkippedAndSaid) {
  const auto states = short_flight();
  const std::string whole = tlog_of(states);
  const std::size_t length = 8 + 12 + 40;  // of the last record, of the gimbal
  const std::size_t at = whole.size() - length;
  const FlightLog log = read_tlog(whole.substr(0, at) + "rubbish\xfd" + whole.substr(at));
  EXPECT_EQ(log.damage, "8 bytes are no record, the first at byte " + std::to_string(at));
  EXPECT_EQ(log.find("camera")->size(), states.size());
  // One bit: the checksum is wrong, and that packet alone is lost.
  std::string turned = whole;
  turned[at + 30] = static_cast<char>(turned[at + 30] ^ 4);
  const FlightLog less = read_tlog(turned);
  EXPECT_EQ(less.damage, "the last 60 bytes are no record");
  EXPECT_EQ(less.find("camera")->size(), states.size() - 1);
}

TEST(Tlog, AFileCutAnywhereGivesWhatIsWhole) {
  const auto reader = reader_named("tlog");
  const std::string bytes = tlog_of(recorded(ideal_flight(wave_plan(1), 10, 0, 0), {.clock = 5}));
  EXPECT_GT(read_cut(*reader, bytes), bytes.size() / 2);
  const FlightLog cut = read_tlog(bytes.substr(0, bytes.size() - 2));
  EXPECT_EQ(cut.damage,
            "it ends within a record at byte " + std::to_string(bytes.size() - 8 - 12 - 40));
}

TEST(Tlog, RefusesWhatIsNone) {
  const auto reader = reader_named("tlog");
  EXPECT_FALSE(reader->recognizes("no log of any kind"));
  EXPECT_THAT(refusal_of(*reader, "no log of any kind"), HasSubstr("there is no whole record"));
  WireSender sender;
  EXPECT_THAT(refusal_of(*reader, tlog_record(0, wire_heartbeat(sender))),
              HasSubstr("expected LOCAL_POSITION_NED or GLOBAL_POSITION_INT"));
  // A place of memory that nobody reads.
  const std::size_t size = (std::size_t{1} << 30) + 1;
  void* place =
      ::mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(place, MAP_FAILED);
  try {
    reader->read({static_cast<const char*>(place), size});
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("at most 1 GiB"));
  }
  ::munmap(place, size);
}

}  // namespace
}  // namespace lapwing
