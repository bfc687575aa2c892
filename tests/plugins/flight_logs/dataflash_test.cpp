// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/flight_logs/reader_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(Dataflash, ReadsWhatWasWritten) {
  const auto states = short_flight();
  const auto reader = reader_named("dataflash");
  const std::string bytes = dataflash_of(states);
  ASSERT_TRUE(reader->recognizes(bytes));
  const FlightLog log = reader->read(bytes);
  EXPECT_THAT(faults_of(log), IsEmpty());
  EXPECT_EQ(log.damage, "");
  ASSERT_EQ(log.find("position")->size(), states.size());  // of the first core alone
  for (std::size_t i = 0; i < states.size(); i += 5) {
    const RecordedState& s = states[i];
    EXPECT_LT((row_of(log, "position", i) - s.position).norm(), 1e-5);
    EXPECT_LT((row_of(log, "velocity", i) - s.velocity).norm(), 1e-5);
    EXPECT_NEAR(std::remainder(row_of(log, "yaw", i)[0] - s.yaw, 2 * M_PI), 0, 1e-4);
    EXPECT_NEAR(row_of(log, "camera", i)[1], s.camera.y(), 1e-6);
    EXPECT_NEAR(std::remainder(row_of(log, "camera", i)[0] - s.camera.x(), 2 * M_PI), 0, 1e-6);
  }
  EXPECT_NEAR(log.reference->latitude_deg, kWaveLatitude, 1e-7);
}

TEST(Dataflash, AFileCutAnywhereGivesWhatIsWhole) {
  const auto reader = reader_named("dataflash");
  const std::string bytes =
      dataflash_of(recorded(ideal_flight(wave_plan(1), 10, 0, 0), {.clock = 5}));
  EXPECT_GT(read_cut(*reader, bytes), bytes.size() / 2);
  const FlightLog cut = reader->read(std::string_view(bytes).substr(0, bytes.size() - 2));
  EXPECT_THAT(cut.damage, HasSubstr("it ends within a message MNT at byte "));
}

TEST(Dataflash, BytesBetweenMessagesAreSkippedAndSaid) {
  const auto states = short_flight();
  const std::string whole = dataflash_of(states);
  const std::size_t at = whole.size() - 19;  // before the last MNT
  const std::string bytes = whole.substr(0, at) + "rubbish\xa3" + whole.substr(at);
  const FlightLog log = reader_named("dataflash")->read(bytes);
  EXPECT_THAT(log.damage, HasSubstr("8 bytes are no message, the first at byte "));
  EXPECT_EQ(log.find("camera")->size(), states.size());
}

constexpr unsigned char kCamera = 13;  // the kind MNT of dataflash_of, 19 bytes

// The place of message `number` of a kind, counted from 0.
std::size_t place_of_message(const std::string& bytes, unsigned char kind, std::size_t number) {
  const std::string head = dataflash_head(kind);
  std::size_t at = bytes.find(head);
  for (; number > 0; --number) at = bytes.find(head, at + 1);
  return at;
}

TEST(Dataflash, AWholeMessageThatCannotBeUsedCostsNoOther) {
  const auto states = short_flight();
  const std::string whole = dataflash_of(states);
  const std::size_t first = place_of_message(whole, kCamera, 0);
  ASSERT_LT(first, whole.size());
  // Of a later version: a type '?', in a message whose body holds what looks like another one.
  const std::string kind = dataflash_kind(201, 3 + 2 * 19, "NEW", "Q?", "TimeUS,What");
  const std::string last = whole.substr(whole.size() - 19);
  std::string bytes = whole.substr(0, first) + kind;
  for (int k = 0; k < 3; ++k) bytes += dataflash_head(201) + last + last;
  bytes += whole.substr(first);
  const FlightLog log = reader_named("dataflash")->read(bytes);
  EXPECT_EQ(log.find("camera")->size(), states.size()) << "none is invented, none is lost";
  EXPECT_EQ(log.damage,
            "4 messages cannot be used, the first FMT at byte " + std::to_string(first));
  EXPECT_EQ(log.bytes_read, whole.size());
}

TEST(Dataflash, AMessageThatLostBytesIsNotInvented) {
  const auto states = short_flight();
  const std::string whole = dataflash_of(states);
  const std::size_t torn = place_of_message(whole, kCamera, 4);
  for (std::size_t lost = 1; lost < 8; ++lost) {
    std::string bytes = whole;
    bytes.erase(torn + 11, lost);
    const FlightLog log = reader_named("dataflash")->read(bytes);
    EXPECT_THAT(faults_of(log), IsEmpty()) << lost;
    EXPECT_EQ(log.find("camera")->size(), states.size() - 1) << lost;
    EXPECT_THAT(log.damage, HasSubstr("bytes are no message")) << lost;
    EXPECT_NEAR(row_of(log, "camera", 4)[1], states[5].camera.y(), 1e-6) << lost;
  }
}

// GPS as ArduPilot writes it, with the units and multipliers of FMTU.
TEST(Dataflash, ScalesByTypesAndMultipliers) {
  std::string bytes =
      dataflash_kind(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns") +
      dataflash_kind(130, 44, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds") +
      dataflash_kind(131, 20, "MULT", "Qbd", "TimeUS,Id,Mult") +
      dataflash_kind(20, 30, "GPS", "QBIHLLe", "TimeUS,Status,GMS,GWk,Lat,Lng,Alt") +
      dataflash_kind(21, 17, "BAT", "Qhhh", "TimeUS,Volt,Curr,RemPct") +
      dataflash_kind(22, 17, "ATT", "Qhhh", "TimeUS,Roll,Pitch,Yaw");
  const auto factor = [&](char id, double value) {
    bytes += dataflash_head(131);
    put(bytes, std::uint64_t{0});
    put(bytes, id);
    put(bytes, value);
  };
  factor('-', 0);
  factor('B', 1e-2);
  factor('F', 1e-6);
  const auto units = [&](unsigned char kind, const char* unit, const char* mult) {
    bytes += dataflash_head(130);
    put(bytes, std::uint64_t{0});
    put(bytes, kind);
    bytes += padded_text(unit, 16) + padded_text(mult, 16);
  };
  units(21, "svA%", "FBB-");
  units(22, "srrr", "FBBB");  // radians in hundredths
  for (int k = 0; k < 3; ++k) {
    bytes += dataflash_head(20);
    put(bytes, microseconds(10 + k));
    put(bytes, std::uint8_t{static_cast<std::uint8_t>(k == 0 ? 1 : 3)});
    put(bytes, std::uint32_t{3600000});
    put(bytes, std::uint16_t{2300});
    put(bytes, std::int32_t{465191000});
    put(bytes, std::int32_t{65668000});
    put(bytes, std::int32_t{39512});
    bytes += dataflash_head(21);
    put(bytes, microseconds(10 + k));
    for (const int v : {1480, 950, 75}) put(bytes, static_cast<std::int16_t>(v));
    bytes += dataflash_head(22);
    put(bytes, microseconds(10 + k));
    for (const int v : {0, 0, 157}) put(bytes, static_cast<std::int16_t>(v));
  }
  const FlightLog log = reader_named("dataflash")->read(bytes);
  EXPECT_EQ(log.damage, "");
  ASSERT_EQ(log.find("gps")->size(), 2u);  // one has no fix
  EXPECT_LT((row_of(log, "gps", 0) - Eigen::Vector3d(46.5191, 6.5668, 395.12)).norm(), 1e-9);
  // Week 2300 and an hour, less 18 leap seconds, at 11 s of the log.
  EXPECT_NEAR(*log.utc, 315964800 + 2300.0 * 604800 + 3600 - 18 - 11, 1e-3);
  EXPECT_LT((row_of(log, "battery", 0) - Eigen::Vector3d(14.8, 9.5, 0.75)).norm(), 1e-9);
  EXPECT_NEAR(row_of(log, "yaw", 0)[0], M_PI / 2 - 1.57, 1e-9);
}

TEST(Dataflash, RefusesWhatIsNone) {
  const auto reader = reader_named("dataflash");
  EXPECT_THAT(refusal_of(*reader, "no log"), HasSubstr("a DataFlash log begins with"));
  EXPECT_THAT(refusal_of(*reader, dataflash_kind(128, 89, "FMT", "BBnNZ", "Type")),
              HasSubstr("expected POS, XKF1 or GPS"));
}

}  // namespace
}  // namespace lapwing
