// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "framework/core/error.h"
#include "framework/survey/cloud_reader.h"
#include "tests/survey/made_clouds.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

const std::vector<Vector3d> kPlaces{{100.5, -200.25, 3.125}, {-7, 8, 9}, {0, 0, -1.5}};

std::vector<CloudPoint> points_of_las(const std::string& bytes, const std::string& name = "a.las") {
  const auto reader = open_cloud(StreamBytes(bytes, name), ".las");
  std::vector<CloudPoint> points(100);
  points.resize(reader->read(points));
  return points;
}

std::string refusal_of_las(const std::string& bytes, const std::string& name = "a.las") {
  try {
    points_of_las(bytes, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LasCloud, AllVersionsAndPointFormats) {
  for (int minor = 2; minor <= 4; ++minor)
    for (int format = 0; format <= (minor == 2 ? 3 : minor == 3 ? 5 : 10); ++format) {
      SCOPED_TRACE(testing::Message() << "1." << minor << ", " << format);
      MadeLas las{.minor = minor, .format = format, .extra = format % 3};
      las.classes = {2, 6, 31};
      const std::string bytes = las_bytes(kPlaces, las);
      const std::vector<CloudPoint> read = points_of_las(bytes);
      ASSERT_EQ(read.size(), 3u);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT((read[i].position - kPlaces[i]).norm(), 1e-9);
        EXPECT_EQ(read[i].classification, las.classes[i]);
        EXPECT_FALSE(read[i].withheld);
      }
      const auto header = open_cloud(StreamBytes(bytes, "a"), ".las")->header();
      EXPECT_EQ(header.points, 3u);
      EXPECT_TRUE(header.bounds->min().isApprox(Vector3d(-7, -200.25, -1.5)));
      EXPECT_THAT(header.format, HasSubstr("point format " + std::to_string(format)));
    }
}

TEST(LasCloud, ScalesOffsetsAndFlags) {
  MadeLas las;
  las.scale = {0.5, 0.25, 0.125};
  las.offset = {84000, 447000, -10};
  const std::vector<Vector3d> far{{84100.5, 447200.25, 3.125}};
  std::string bytes = las_bytes(far, las);
  EXPECT_EQ(points_of_las(bytes).at(0).position, far[0]);
  // Old formats: class in five bits, then synthetic, key point, withheld.
  bytes[227 + 15] = static_cast<char>(0x80 | 0x20 | 7);
  EXPECT_TRUE(points_of_las(bytes).at(0).withheld);
  EXPECT_EQ(points_of_las(bytes).at(0).classification, 7);
  std::string newer = las_bytes(far, {.minor = 4, .format = 6});
  newer[375 + 15] = 4;
  EXPECT_TRUE(points_of_las(newer).at(0).withheld);
}

constexpr std::uint16_t kOwn = 32767;

std::string system_of_keys_in(std::vector<std::uint16_t> keys) {
  const std::string bytes = las_bytes(kPlaces, {.keys = std::move(keys)});
  const CloudHeader header = open_cloud(StreamBytes(bytes, "a"), ".las")->header();
  return header.system + "|" + header.system_note;
}

TEST(LasCloud, ReferenceSystems) {
  EXPECT_EQ(system_of_keys_in({}), "|");
  EXPECT_EQ(system_of_keys_in({1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 28992}), "EPSG:28992|");
  EXPECT_EQ(system_of_keys_in({1, 1, 0, 2, 3072, 0, 1, 28992, 4096, 0, 1, 5709}),
            "EPSG:28992+5709|");
  EXPECT_EQ(system_of_keys_in({1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326}), "EPSG:4326|");
  EXPECT_THAT(system_of_keys_in({1, 1, 0, 1, 3072, 0, 1, kOwn}), HasSubstr("of their own"));
  EXPECT_THAT(system_of_keys_in({1, 1, 0, 9, 3072, 0, 1, 28992}), HasSubstr("damaged"));
  const std::string feet =
      las_bytes(kPlaces, {.keys = {1, 1, 0, 2, 3072, 0, 1, 2263, 4099, 0, 1, 9003}});
  EXPECT_NEAR(open_cloud(StreamBytes(feet, "a"), ".las")->header().height_unit, 0.3048006, 1e-7);
  for (const bool late : {false, true}) {
    MadeLas las{.minor = 4, .format = 6, .wkt = "PROJCRS[\"x\"]", .late = late};
    las.keys = {1, 1, 0, 1, 3072, 0, 1, 28992};
    const std::string bytes = las_bytes(kPlaces, las);
    EXPECT_EQ(open_cloud(StreamBytes(bytes, "a"), ".las")->header().system, "PROJCRS[\"x\"]");
    EXPECT_EQ(points_of_las(bytes).size(), 3u);
  }
}

TEST(LasCloud, CompressedOnesAreRefusedWithTheCommand) {
  std::string bytes = las_bytes(kPlaces, {.minor = 4, .format = 6});
  bytes[104] = static_cast<char>(0x80 | 6);
  EXPECT_THAT(refusal_of_las(bytes, "town.laz"),
              AllOf(HasSubstr("LAZ"), HasSubstr("pdal translate 'town.laz' 'town.las'")));
  EXPECT_THAT(refusal_of_las(las_bytes(kPlaces, {.other_user = "laszip encoded"})),
              HasSubstr("pdal translate"));
  // Cut short in the header.
  EXPECT_THAT(refusal_of_las(bytes.substr(0, 150), "town.laz"), HasSubstr("cut short"));
}

TEST(LasCloud, WhatIsWrongIsSaid) {
  const std::string whole = las_bytes(kPlaces, {});
  EXPECT_THAT(refusal_of_las(whole.substr(0, whole.size() - 1)),
              AllOf(HasSubstr("'a.las'"), HasSubstr("states 3 points of 20 bytes, and 2")));
  EXPECT_THAT(refusal_of_las("LASF"), HasSubstr("cut short"));
  EXPECT_THAT(refusal_of_las("ply\n"), HasSubstr("LASF"));
  const auto changed = [&](std::size_t place, char byte) {
    std::string bytes = whole;
    bytes[place] = byte;
    return refusal_of_las(bytes);
  };
  EXPECT_THAT(changed(25, 5), HasSubstr("LAS 1.5"));
  EXPECT_THAT(changed(104, 11), HasSubstr("format 11"));
  EXPECT_THAT(changed(105, 19), HasSubstr("19 are stated"));
  EXPECT_THAT(changed(96, 10), HasSubstr("damaged"));
  EXPECT_THAT(changed(96 + 3, 10), HasSubstr("cut short"));
  MadeLas flat;
  flat.scale.y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of_las(las_bytes(kPlaces, flat)), HasSubstr("scales"));
}

}  // namespace
}  // namespace lapwing
