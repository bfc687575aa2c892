// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>

#include <ctime>

#include "tests/plugins/flight_logs/reader_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(Ulog, ReadsWhatWasWritten) {
  const auto states = short_flight();
  const auto reader = reader_named("ulog");
  const std::string bytes = ulog_of(states, true, {101, 102});
  ASSERT_TRUE(reader->recognizes(bytes));
  const FlightLog log = reader->read(bytes);
  EXPECT_THAT(faults_of(log), IsEmpty());
  EXPECT_EQ(log.damage, "");
  EXPECT_EQ(log.bytes_read, bytes.size());
  ASSERT_EQ(log.find("position")->size(), states.size());
  for (std::size_t i = 0; i < states.size(); i += 5) {
    const RecordedState& s = states[i];
    EXPECT_NEAR(log.find("position")->times[i], s.time, 1e-6);
    EXPECT_LT((row_of(log, "position", i) - s.position).norm(), 1e-5);
    EXPECT_LT((row_of(log, "velocity", i) - s.velocity).norm(), 1e-5);
    EXPECT_NEAR(std::remainder(row_of(log, "yaw", i)[0] - s.yaw, 2 * M_PI), 0, 1e-5);
    EXPECT_NEAR(std::remainder(row_of(log, "camera", i)[0] - s.camera.x(), 2 * M_PI), 0, 1e-5);
    EXPECT_NEAR(row_of(log, "camera", i)[1], s.camera.y(), 1e-5);
  }
  EXPECT_NEAR(log.reference->latitude_deg, kWaveLatitude, 1e-12);
  EXPECT_NEAR(log.reference->altitude, kWaveHeight, 1e-9);
  EXPECT_EQ(log.heights, HeightOf::sea);
  EXPECT_THAT(log.photographs, testing::ElementsAre(101, 102));
}

TEST(Ulog, AFileCutAnywhereGivesWhatIsWhole) {
  const auto reader = reader_named("ulog");
  const std::string bytes = ulog_of(recorded(ideal_flight(wave_plan(1), 10, 0, 0), {.clock = 5}));
  EXPECT_GT(read_cut(*reader, bytes), bytes.size() / 2);
  const FlightLog cut = reader->read(std::string_view(bytes).substr(0, bytes.size() - 10));
  EXPECT_THAT(cut.damage, HasSubstr("it ends within a record 'D' at byte "));
}

TEST(Ulog, DropoutsInstancesAndMessagesAreCounted) {
  const auto states = short_flight();
  std::string bytes = ulog_head() + ulog_formats() + ulog_topic(9, "vehicle_attitude", 1);
  for (const RecordedState& s : states) bytes += ulog_state(s, true);
  std::string other;  // another instance, which is not read
  put(other, std::uint16_t{9});
  put(other, microseconds(101));
  put_floats(other, {1, 0, 0, 0});
  bytes += ulog_record('D', other);
  std::string lost;
  put(lost, std::uint16_t{250});
  bytes += ulog_record('O', lost);
  std::string said(1, '6');
  put(said, microseconds(102));
  bytes += ulog_record('L', said + "Takeoff");
  const FlightLog log = reader_named("ulog")->read(bytes);
  ASSERT_EQ(log.gaps.size(), 1u);
  EXPECT_NEAR(log.gaps[0].duration, 0.25, 1e-12);
  EXPECT_EQ(log.messages[0].text, "Takeoff");
  EXPECT_NEAR(log.messages[0].time, 102, 1e-9);
  std::map<std::string, std::size_t> counts;
  for (const LogRecords& records : log.records) counts[records.name] = records.count;
  EXPECT_EQ(counts["vehicle_attitude"], states.size());
  EXPECT_EQ(counts["vehicle_attitude#1"], 1u);
  EXPECT_EQ(log.find("orientation")->size(), states.size());
}

TEST(Ulog, AppendedDataAreReadAndTheRestOfAPartIsLeft) {
  const auto states = short_flight();
  std::string first = ulog_head(1) + ulog_formats();
  for (std::size_t i = 0; i < 20; ++i) first += ulog_state(states[i], true);
  first += std::string("\x40\x00\x44\x01", 4);  // a record that a crash cut
  std::string bytes = ulog_head(first.size()) + first.substr(ulog_head(1).size());
  for (std::size_t i = 20; i < 30; ++i) bytes += ulog_state(states[i], true);
  const FlightLog log = reader_named("ulog")->read(bytes);
  EXPECT_EQ(log.damage, "");
  EXPECT_EQ(log.find("position")->size(), 30u);
}

TEST(Ulog, BytesThatAreNoRecordAreSkippedToTheNextSync) {
  const auto states = short_flight();
  std::string bytes = ulog_head() + ulog_formats();
  bytes += ulog_state(states[0], true) + ulog_state(states[1], true);
  bytes += std::string(50, '\x01');
  bytes += ulog_record('S', std::string("\x2f\x73\x13\x20\x25\x0c\xbb\x12", 8));
  bytes += ulog_state(states[2], true);
  const FlightLog log = reader_named("ulog")->read(bytes);
  EXPECT_EQ(log.find("position")->size(), 3u);
  EXPECT_THAT(log.damage, HasSubstr("begins no record"));
  EXPECT_EQ(log.bytes_read, bytes.size() - 50);
}

// Data of a topic that was never subscribed.
std::string foreign_record() {
  std::string body;
  put(body, std::uint16_t{77});
  put(body, microseconds(100));
  return ulog_record('D', body + std::string(20, 'x'));
}

TEST(Ulog, AWholeRecordThatCannotBeUsedCostsNoOther) {
  const auto states = short_flight();
  std::string bytes = ulog_head() + ulog_formats();
  const std::size_t first = bytes.size() + ulog_state(states[0], true).size();
  for (std::size_t i = 0; i < 20; ++i) {
    bytes += ulog_state(states[i], true);
    if (i % 4 == 0) bytes += foreign_record();
    if (i == 7) bytes += ulog_record('R', std::string(2, '\x55')) + ulog_topic(60, "undefined");
  }
  const FlightLog log = reader_named("ulog")->read(bytes);
  EXPECT_EQ(log.find("position")->size(), 20u);
  EXPECT_EQ(log.damage, "7 records cannot be used, the first 'D' at byte " + std::to_string(first));
  EXPECT_EQ(log.bytes_read, bytes.size() - 5 * foreign_record().size() -
                                ulog_record('R', std::string(2, 'x')).size() -
                                ulog_topic(60, "undefined").size());
}

TEST(Ulog, AFileWithoutSyncsGoesOnBehindWhatIsNoRecord) {
  const auto states = short_flight();
  std::string bytes = ulog_head() + ulog_formats();
  for (std::size_t i = 0; i < 20; ++i) {
    if (i == 10) bytes += std::string(50, '\x01');
    bytes += ulog_state(states[i], true);
  }
  const FlightLog log = reader_named("ulog")->read(bytes);
  EXPECT_EQ(log.find("position")->size(), 20u);
  EXPECT_EQ(log.bytes_read, bytes.size() - 50);
  EXPECT_THAT(log.damage, HasSubstr("begins no record; 50 bytes were skipped"));
}

// The places that a log gives are those of the flight; its times name them.
void expect_no_invented_position(const FlightLog& log, const std::vector<RecordedState>& states) {
  const LogSeries& positions = *log.find("position");
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto state = std::find_if(states.begin(), states.end(), [&](const RecordedState& s) {
      return std::abs(s.time - positions.times[i]) < 1e-4;
    });
    ASSERT_NE(state, states.end()) << positions.times[i];
    EXPECT_LT((row_of(log, "position", i) - state->position).norm(), 1e-5);
  }
}

// Where bytes of a record were lost, its stated length reaches into the ones behind it: to the
// middle of one, to the end of one, or of the file.
TEST(Ulog, ARecordThatLostBytesIsNotInvented) {
  const auto states = short_flight();
  for (const std::size_t torn_one : {10, 17, 18, 19})
    for (std::size_t kept = 13; kept < 24; ++kept)
      for (std::size_t lost = 1; lost + kept < 60; ++lost) {
        std::string bytes = ulog_head() + ulog_formats();
        for (std::size_t i = 0; i < 20; ++i) {
          std::string state = ulog_state(states[i], true);
          if (i == torn_one) state.erase(kept, lost);
          bytes += state;
        }
        SCOPED_TRACE(std::to_string(lost) + " lost behind " + std::to_string(kept) + " of " +
                     std::to_string(torn_one));
        const FlightLog log = reader_named("ulog")->read(bytes);
        EXPECT_THAT(faults_of(log), IsEmpty());
        EXPECT_NE(log.damage, "");
        EXPECT_EQ(log.find("position")->size(), 19u);
        EXPECT_EQ(log.find("orientation")->size(), 20u);
        expect_no_invented_position(log, states);
      }
}

TEST(Ulog, DataLongerThanTheirFormatAreNotUsed) {
  const auto states = short_flight();
  for (const std::size_t more : {7, 8}) {  // up to 7 bytes pad the end
    std::string bytes = ulog_head() + ulog_formats();
    for (std::size_t i = 0; i < 10; ++i) {
      std::string state = ulog_state(states[i], true);
      if (i == 4) state.insert(3 + std::size_t{static_cast<unsigned char>(state[0])}, more, 'x');
      if (i == 4) state[0] = static_cast<char>(state[0] + static_cast<char>(more));
      bytes += state;
    }
    const FlightLog log = reader_named("ulog")->read(bytes);
    EXPECT_EQ(log.find("position")->size(), more == 7 ? 10u : 9u);
    EXPECT_THAT(log.damage, testing::StartsWith(more == 7 ? "" : "1 record cannot be used"));
    EXPECT_EQ(log.damage.empty(), more == 7);
  }
}

TEST(Ulog, ElementsOfArraysAreWhereTheirFormatsSay) {
  for (const int elements : {2, 3}) {  // with two, xyz[2] is no element: not the number behind them
    std::string bytes = ulog_head() + ulog_formats() + ulog_format("pair:float a;double[2] b;") +
                        ulog_format("vehicle_thrust_setpoint:uint64_t timestamp;pair[2] p;float[" +
                                    std::to_string(elements) + "] xyz;float w;") +
                        ulog_topic(5, "vehicle_thrust_setpoint");
    for (const RecordedState& state : short_flight()) bytes += ulog_state(state, true);
    std::string body;
    put(body, std::uint16_t{5});
    put(body, microseconds(101));
    for (int k = 0; k < 2; ++k) {
      put(body, 1.0f);
      for (const double b : {2.0, 3.0}) put(body, b);
    }
    for (int k = 0; k <= elements; ++k) put(body, -0.25f * static_cast<float>(k));
    bytes += ulog_record('D', body);
    const FlightLog log = reader_named("ulog")->read(bytes);
    EXPECT_EQ(log.damage, "");
    const auto* throttle = log.find("throttle");
    if (elements == 2) {
      EXPECT_EQ(throttle, nullptr);
    } else {
      ASSERT_NE(throttle, nullptr);
      EXPECT_NEAR(row_of(log, "throttle", 0)[0], 0.5, 1e-6);
    }
  }
}

TEST(Ulog, RefusesWhatItDoesNotKnow) {
  const auto reader = reader_named("ulog");
  EXPECT_THAT(refusal_of(*reader, "ULog"), HasSubstr("a ULog begins with"));
  EXPECT_THAT(refusal_of(*reader, ulog_head(0, 2) + ulog_formats()),
              HasSubstr("a feature of ULog that this version does not know"));
  EXPECT_THAT(refusal_of(*reader, ulog_head() + ulog_formats()),
              HasSubstr("expected vehicle_local_position"));
}

// Of the processor, since `began`.
double seconds_since(std::clock_t began) {
  return static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
}

// Files whose formats are many times as large as they are.
std::vector<std::string> hostile_formats() {
  std::string deep = ulog_head();
  for (int k = 0; k < 40; ++k)
    deep += ulog_format("f" + std::to_string(k) + ":f" + std::to_string(k + 1) + "[65535] a;");
  deep += ulog_topic(1, "f0");
  // A topic of one array.
  const auto wide_topic = [](int k, const std::string& element) {
    const std::string name = "w" + std::to_string(k);
    return ulog_format(name + ":" + element + "[65535] " + std::string(200, 'a') + ";") +
           ulog_topic(static_cast<std::uint16_t>(k), name);
  };
  std::string wide = ulog_head(), wide_within = ulog_head() + ulog_format("e:uint8_t a;");
  for (int k = 0; k < 3000; ++k) {
    wide += wide_topic(k, "uint8_t");
    wide_within += wide_topic(k, "e");
  }
  const std::string self = ulog_head() + ulog_format("a:a b;") + ulog_topic(1, "a");
  // Each is refused at its last field.
  const auto two_of = [](const std::string& name, const std::string& inner) {
    return ulog_format(name + ":" + inner + " a;" + inner + " b;");
  };
  std::string doubled = ulog_head() + two_of("d0", "uint8_t");
  for (int k = 1; k < 16; ++k)
    doubled += two_of("d" + std::to_string(k), "d" + std::to_string(k - 1));
  for (int k = 0; k < 3000; ++k) {
    const std::string name = "r" + std::to_string(k);
    doubled += two_of(name, "d14");
    doubled += ulog_topic(1, name);
  }
  return {deep, wide, wide_within, self, doubled};
}

TEST(Ulog, HostileFormatsTakeNoTime) {
  const auto reader = reader_named("ulog");
  for (const std::string& bytes : hostile_formats()) {
    const std::clock_t began = std::clock();
    EXPECT_NE(refusal_of(*reader, bytes), "");
    EXPECT_LT(seconds_since(began), 2);
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they keep what is freed
// The most memory that the process had, MB.
double peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// In a process of its own: the peak of this one may be that of another test.
TEST(Ulog, HostileFormatsTakeNoMemory) {
  const auto reader = reader_named("ulog");
  for (const std::string& bytes : hostile_formats()) {
    EXPECT_EXIT(
        {
          const double before = peak_memory();
          refusal_of(*reader, bytes);
          const double taken = peak_memory() - before;
          std::fprintf(stderr, "%.0f MB", taken);
          std::exit(taken < 200 ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
  }
}
#endif

// Places where a record seems to begin, in a row, overlapping, or within a record.
TEST(Ulog, HostileRecordsTakeNoTime) {
  const std::string head = ulog_head() + ulog_formats(), dropout("\2\0O\0\0", 5);
  std::string dropouts, heads, records;
  for (int k = 0; k < 12000; ++k) dropouts += dropout;
  for (int k = 0; k < 1000000; ++k) heads += std::string("\x44\x44\x44", 3);
  for (int k = 0; k < 60; ++k) records += ulog_record('D', dropouts);
  const std::string within = records + 'x' + heads;
  for (const std::string& rest : {heads, records, within}) {
    const std::clock_t began = std::clock();
    EXPECT_NE(refusal_of(*reader_named("ulog"), head + rest), "");
    EXPECT_LT(seconds_since(began), 5);
  }
}

// Counted by a program of its own: the number of messages of each topic.
TEST(Ulog, RealLogsAreReadWhole) {
  struct Expected {
    const char* file;
    std::map<std::string, std::size_t> counts;
    std::size_t gaps, messages;
  };
  const std::vector<Expected> all{{"px4_small.ulg",
                                   {{"vehicle_attitude", 1298},
                                    {"vehicle_local_position", 636},
                                    {"battery_status#1", 21},
                                    {"actuator_controls_0", 1812},
                                    {"vehicle_gps_position", 32}},
                                   1,
                                   3},
                                  {"px4_events.ulg",
                                   {{"vehicle_attitude", 622},
                                    {"vehicle_local_position", 313},
                                    {"sensor_combined", 7783},
                                    {"vehicle_thrust_setpoint", 1558},
                                    {"trajectory_setpoint", 157}},
                                   0,
                                   18}};
  for (const Expected& expected : all) {
    const auto file = shared_log(expected.file);
    if (file.empty()) GTEST_SKIP() << "no real logs; LAPWING_DATA names their folder";
    const FlightLog log = reader_named("ulog")->read(read_file(file));
    EXPECT_EQ(log.damage, "");
    EXPECT_EQ(log.bytes_read, log.bytes);
    EXPECT_THAT(faults_of(log), IsEmpty());
    EXPECT_EQ(log.gaps.size(), expected.gaps);
    std::map<std::string, std::size_t> counts;
    for (const LogRecords& records : log.records) counts[records.name] = records.count;
    for (const auto& [name, count] : expected.counts) EXPECT_EQ(counts[name], count) << name;
    std::size_t said = 0;
    for (const LogMessage& message : log.messages)
      said += !message.text.starts_with("navigation state");
    EXPECT_EQ(said, expected.messages);
  }
}

}  // namespace
}  // namespace lapwing
