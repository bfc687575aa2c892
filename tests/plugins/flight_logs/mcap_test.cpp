// SPDX-License-Identifier: Apache-2.0
#include <lz4frame.h>
#include <zstd.h>

#include "framework/export/exporter.h"
#include "tests/plugins/flight_logs/reader_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::string kMcapMagic("\x89MCAP0\r\n", 8);

std::string mcap_record(char code, const std::string& body) {
  std::string out(1, code);
  put(out, static_cast<std::uint64_t>(body.size()));
  return out + body;
}

std::string mcap_text(const std::string& text) {
  std::string out;
  put(out, static_cast<std::uint32_t>(text.size()));
  return out + text;
}

std::string mcap_channel(const std::string& encoding = "json") {
  std::string schema, channel;
  put(schema, std::uint16_t{1});
  schema += mcap_text("foxglove.FrameTransform") + mcap_text("jsonschema") + mcap_text("{}");
  put(channel, std::uint16_t{7});
  put(channel, std::uint16_t{1});
  channel += mcap_text("/tf") + mcap_text(encoding) + std::string(4, '\0');
  return mcap_record(3, schema) + mcap_record(4, channel);
}

std::string mcap_pose(const RecordedState& s) {
  std::string body;
  put(body, std::uint16_t{7});
  put(body, std::uint32_t{0});
  put(body, static_cast<std::uint64_t>(std::llround(1e9 * s.time)));
  put(body, std::uint64_t{0});
  const Eigen::Quaterniond& q = s.orientation;
  return mcap_record(
      5,
      body + printed("{\"child_frame_id\":\"base_link\",\"translation\":{\"x\":%.9f,\"y\":%.9f,"
                     "\"z\":%.9f},\"rotation\":{\"x\":%.9f,\"y\":%.9f,\"z\":%.9f,\"w\":%.9f}}",
                     s.position.x(), s.position.y(), s.position.z(), q.x(), q.y(), q.z(), q.w()));
}

std::string mcap_chunk(const std::string& records, const std::string& compression,
                       std::uint64_t size) {
  std::string packed = records;
  if (compression == "zstd") {
    packed.resize(ZSTD_compressBound(records.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), records.data(), records.size(), 3));
  } else if (compression == "lz4") {
    packed.resize(LZ4F_compressFrameBound(records.size(), nullptr));
    packed.resize(
        LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
  }
  std::string body(16, '\0');
  put(body, size);
  put(body, std::uint32_t{0});
  body += mcap_text(compression);
  put(body, static_cast<std::uint64_t>(packed.size()));
  return mcap_record(6, body + packed);
}

std::string mcap_file(const std::string& records) {
  return kMcapMagic + mcap_record(1, mcap_text("") + mcap_text("test")) + records +
         mcap_record(15, std::string(4, '\0')) + mcap_record(2, std::string(20, '\0')) + kMcapMagic;
}

std::string mcap_poses(const std::vector<RecordedState>& states) {
  std::string records;
  for (const RecordedState& s : states) records += mcap_pose(s);
  return records;
}

TEST(McapLog, ReadsChunksOfEveryCompression) {
  const auto states = short_flight();
  const std::string records = mcap_channel() + mcap_poses(states);
  for (const std::string compression : {"none at all", "", "zstd", "lz4"}) {
    const std::string bytes = mcap_file(
        compression == "none at all" ? records : mcap_chunk(records, compression, records.size()));
    const auto reader = reader_named("mcap");
    ASSERT_TRUE(reader->recognizes(bytes));
    const FlightLog log = reader->read(bytes);
    EXPECT_EQ(log.damage, "") << compression;
    EXPECT_THAT(faults_of(log), IsEmpty());
    ASSERT_EQ(log.find("position")->size(), states.size()) << compression;
    EXPECT_LT((row_of(log, "position", 20) - states[20].position).norm(), 1e-8);
    EXPECT_NEAR(log.find("position")->times[20], states[20].time - states[0].time, 1e-8);
    EXPECT_NEAR(std::remainder(row_of(log, "yaw", 20)[0] - states[20].yaw, 2 * M_PI), 0, 1e-6);
  }
}

TEST(McapLog, ChunksThatLieAreDamage) {
  const std::string records = mcap_channel() + mcap_poses(short_flight());
  const std::string good = mcap_channel() + mcap_poses(short_flight());
  for (const std::string compression : {"zstd", "lz4"})
    for (const std::uint64_t size :
         {records.size() + 1, records.size() - 1, std::size_t{1} << 40}) {
      const FlightLog log =
          reader_named("mcap")->read(mcap_file(good + mcap_chunk(records, compression, size)));
      EXPECT_THAT(log.damage, testing::AnyOf(HasSubstr("a record is not as its kind wants it"),
                                             HasSubstr("it ends within a record at byte")))
          << compression;
    }
  EXPECT_THAT(refusal_of(*reader_named("mcap"), mcap_file(mcap_chunk(records, "brotli", 5))),
              HasSubstr("compressed by 'brotli'"));
}

TEST(McapLog, ReadsItsOwnExportBack) {
  const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  const Plan plan = wave_plan(3);
  const FlightLog log = reader_named("mcap")->read(registry.create<Exporter>("mcap")->write(plan));
  EXPECT_EQ(log.damage, "");
  EXPECT_EQ(log.recorder, "Lapwing");
  EXPECT_EQ(log.find("position")->size(), 151u);
  const Sample s = sample_at(plan.trajectory, 2);
  EXPECT_LT((*value_at(log, "position", 2) - s.position).norm(), 1e-6);
  EXPECT_LT((*value_at(log, "velocity", 2) - s.velocity).norm(), 1e-6);
  EXPECT_NEAR((*value_at(log, "camera", 2))[0], s.yaw + s.gimbal_yaw, 1e-6);
  EXPECT_NEAR((*value_at(log, "camera", 2))[1], s.gimbal_pitch, 1e-6);
}

TEST(McapLog, OtherEncodingsAndFramesAreSaid) {
  const std::string poses = mcap_poses(short_flight());
  EXPECT_THAT(refusal_of(*reader_named("mcap"), mcap_file(mcap_channel("cdr") + poses)),
              HasSubstr("it has /tf (foxglove.FrameTransform, cdr)"));
  Value other = Value::map();
  other.set("vehicle", "tower");
  EXPECT_THAT(refusal_of(*reader_named("mcap", other), mcap_file(mcap_channel() + poses)),
              HasSubstr("no channel of it gives a sample"));
}

TEST(McapLog, AFileCutAnywhereGivesWhatIsWhole) {
  const std::string bytes =
      mcap_file(mcap_channel() + mcap_poses(recorded(ideal_flight(wave_plan(1), 5, 0, 0), {})));
  EXPECT_GT(read_cut(*reader_named("mcap"), bytes), bytes.size() / 3);
}

}  // namespace
}  // namespace lapwing
