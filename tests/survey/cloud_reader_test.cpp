// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/survey/cloud_reader.h"
#include "framework/survey/lzf.h"
#include "tests/survey/made_clouds.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

std::vector<CloudPoint> all_points(CloudReader& reader, std::size_t batch = 3) {
  std::vector<CloudPoint> all, some(batch);
  for (std::size_t count = 0; (count = reader.read(some)) > 0;)
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
  return all;
}

std::vector<CloudPoint> read_cloud_of(const std::string& bytes, const std::string& ending,
                                      const CloudFileOptions& options = {}) {
  return all_points(*open_cloud(StreamBytes(bytes, "cloud" + ending), ending, options));
}

std::string refusal_of_cloud(const std::string& bytes, const std::string& ending,
                             const CloudFileOptions& options = {}) {
  try {
    read_cloud_of(bytes, ending, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_positions(const std::vector<CloudPoint>& read, const std::vector<Vector3d>& points,
                      double within = 1e-4) {
  ASSERT_EQ(read.size(), points.size());
  for (std::size_t i = 0; i < read.size(); ++i)
    EXPECT_LT((read[i].position - points[i]).norm(), within) << i;
}

const std::vector<Vector3d> kFive{
    {1, 2, 3}, {-4.5, 5.25, -6}, {1000.5, -2000.25, 30}, {0, 0, 0}, {7, 8, 9}};

constexpr const char* kPlyProperties =
    "property float x\nproperty float y\nproperty double z\nproperty uchar red\n"
    "property list uchar int marks\nproperty float nx\nproperty float ny\nproperty float nz\n"
    "property uchar scalar_Classification\n";

// Every number in one of the two byte orders.
template <bool kBig>
std::string binary_ply() {
  MadeBytes bytes;
  bytes.text(
      ply_head(kBig ? "binary_big_endian" : "binary_little_endian", kFive.size(), kPlyProperties));
  const auto put = [&](auto value) { kBig ? bytes.put_big(value) : bytes.put(value); };
  for (const Vector3d& p : kFive) {
    put(static_cast<float>(p.x()));
    put(static_cast<float>(p.y()));
    put(p.z());
    put(std::uint8_t{200});
    put(std::uint8_t{2});
    put(std::int32_t{5});
    put(std::int32_t{6});
    put(0.0f);
    put(0.0f);
    put(1.0f);
    put(std::uint8_t{2});
  }
  return bytes.str();
}

TEST(PlyCloud, AllEncodingsWithNormalsAndClasses) {
  std::string text = ply_head("ascii", kFive.size(), kPlyProperties);
  for (const Vector3d& p : kFive)
    text += std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) +
            " 200 2 5 6 0 0 1 2\n";
  for (const std::string& bytes : {text, binary_ply<false>(), binary_ply<true>()}) {
    const auto reader = open_cloud(StreamBytes(bytes, "a.ply"), ".ply");
    EXPECT_TRUE(reader->header().normals);
    EXPECT_TRUE(reader->header().classes);
    EXPECT_EQ(reader->header().points, 5u);
    const std::vector<CloudPoint> read = all_points(*reader);
    expect_positions(read, kFive);
    for (const CloudPoint& point : read) {
      EXPECT_EQ(point.normal, Eigen::Vector3f(0, 0, 1));
      EXPECT_EQ(point.classification, 2);
    }
  }
}

TEST(PlyCloud, WithoutNormalsBehindOtherElements) {
  const std::string bytes =
      "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list uchar float at\r\n"
      "element vertex 2\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
      "element face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n"
      "2 9 9\r\n1 2 3\r\n4 5 6\r\n3 0 1 1\r\n";
  expect_positions(read_cloud_of(bytes, ".PLY"), {{1, 2, 3}, {4, 5, 6}});
  EXPECT_FALSE(open_cloud(StreamBytes(bytes, "a"), ".ply")->header().normals);
}

TEST(PlyCloud, WhatIsWrongIsSaid) {
  const std::string whole = binary_ply<false>();
  EXPECT_THAT(refusal_of_cloud(whole.substr(0, whole.size() - 100), ".ply"),
              AllOf(HasSubstr("'cloud.ply'"), HasSubstr("5 vertex")));
  EXPECT_THAT(refusal_of_cloud(whole.substr(0, whole.size() - 3), ".ply"), HasSubstr("cut short"));
  EXPECT_THAT(
      refusal_of_cloud(ply_head("ascii", 1, "property float x\nproperty float y\n"), ".ply"),
      HasSubstr("claims 1 vertex"));
  EXPECT_THAT(refusal_of_cloud(
                  ply_head("ascii", 1, "property float x\nproperty float y\n") + "1 2\n", ".ply"),
              HasSubstr("lack z"));
  EXPECT_THAT(refusal_of_cloud("ply\nformat ascii 1.0\nend_header\n", ".ply"),
              HasSubstr("no element 'vertex'"));
}

std::string pcd_numbers() {
  MadeBytes bytes;
  for (const Vector3d& p : kFive) {
    for (int axis = 0; axis < 3; ++axis) bytes.put(static_cast<float>(p[axis]));
    bytes.put(0.5f);
  }
  return bytes.str();
}

// Field by field.
std::string pcd_columns() {
  MadeBytes bytes;
  for (int axis = 0; axis < 3; ++axis)
    for (const Vector3d& p : kFive) bytes.put(static_cast<float>(p[axis]));
  for (std::size_t i = 0; i < kFive.size(); ++i) bytes.put(0.5f);
  return bytes.str();
}

std::string compressed_pcd(const std::string& packed, std::size_t unpacked) {
  return MadeBytes()
      .text(pcd_head("binary_compressed", kFive.size()))
      .put(static_cast<std::uint32_t>(packed.size()))
      .put(static_cast<std::uint32_t>(unpacked))
      .text(packed)
      .str();
}

TEST(PcdCloud, AllEncodings) {
  std::string text = pcd_head("ascii", kFive.size());
  for (const Vector3d& p : kFive)
    text += std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) +
            " 0.5\n";
  expect_positions(read_cloud_of(text, ".pcd"), kFive);
  expect_positions(read_cloud_of(pcd_head("binary", kFive.size()) + pcd_numbers(), ".pcd"), kFive);
  const std::string columns = pcd_columns();
  expect_positions(read_cloud_of(compressed_pcd(packed_plainly(columns), columns.size()), ".pcd"),
                   kFive);
}

TEST(PcdCloud, PointsWithoutNumbersAndViewpoints) {
  std::string bytes = pcd_head("ascii", 1) + "nan 2 3 4\n";
  bytes.replace(bytes.find("VIEWPOINT 0 0 0"), 15, "VIEWPOINT 1 2 3");
  const auto reader = open_cloud(StreamBytes(bytes, "a"), ".pcd");
  EXPECT_EQ(reader->header().viewpoint, Vector3d(1, 2, 3));
  EXPECT_TRUE(std::isnan(all_points(*reader).at(0).position.x()));
}

TEST(PcdCloud, WhatIsWrongIsSaid) {
  const std::string columns = pcd_columns(), packed = packed_plainly(columns);
  const std::string whole = pcd_head("binary", kFive.size()) + pcd_numbers();
  EXPECT_THAT(refusal_of_cloud(whole.substr(0, whole.size() - 40), ".pcd"),
              AllOf(HasSubstr("cut short"), HasSubstr("states 5 points")));
  EXPECT_THAT(refusal_of_cloud(compressed_pcd(packed, columns.size() + 4), ".pcd"),
              HasSubstr("5 points of 16 bytes"));
  const std::string compressed = compressed_pcd(packed, columns.size());
  EXPECT_THAT(refusal_of_cloud(compressed.substr(0, compressed.size() - 9), ".pcd"),
              HasSubstr("cut short"));
  EXPECT_THAT(refusal_of_cloud(compressed_pcd(packed.substr(0, 40), columns.size()), ".pcd"),
              HasSubstr("damaged"));
  std::string lacks = pcd_head("ascii", 1) + "1 2 3 4\n";
  lacks.replace(lacks.find(" z "), 3, " w ");
  EXPECT_THAT(refusal_of_cloud(lacks, ".pcd"), HasSubstr("lack x, y or z"));
  EXPECT_THAT(refusal_of_cloud("VERSION 0.7\nFIELDS x y z\n", ".pcd"), HasSubstr("no line DATA"));
  std::string huge = pcd_head("binary", kFive.size()) + pcd_numbers();
  huge.replace(huge.find("WIDTH 5"), 7, "WIDTH 9");
  EXPECT_THAT(refusal_of_cloud(huge, ".pcd"), HasSubstr("9 x 1"));
}

// "aaaaaaaaaaabc": one literal, a copy of ten bytes that overlaps itself, two literals.
TEST(Lzf, LiteralsAndCopies) {
  std::vector<char> out;
  const std::string packed{0, 'a', static_cast<char>(7 << 5), 1, 0, 1, 'b', 'c'};
  ASSERT_TRUE(unpack_lzf(packed, 13, out));
  EXPECT_EQ(std::string(out.begin(), out.end()), "aaaaaaaaaaabc");
  // A copy of 3 bytes from 256 + 1 back.
  std::string far;
  for (int i = 0; i < 257; ++i) far += static_cast<char>(i * 7);
  std::string codes = packed_plainly(far);
  codes += {static_cast<char>(1 << 5 | 1), 0};
  ASSERT_TRUE(unpack_lzf(codes, 260, out));
  EXPECT_EQ(std::string(out.end() - 3, out.end()), far.substr(0, 3));
  EXPECT_FALSE(unpack_lzf(packed, 12, out)) << "too long";
  EXPECT_FALSE(unpack_lzf(packed, 14, out)) << "too short";
  EXPECT_FALSE(unpack_lzf(packed.substr(0, 4), 12, out)) << "ends within a code";
  EXPECT_FALSE(unpack_lzf(std::string{0, 'a', 1 << 5, 1}, 4, out)) << "before the first byte";
}

TEST(TextCloud, SeparatorsHeadersAndColumns) {
  const std::vector<Vector3d> two{{1.5, 2.5, 3.5}, {4.5, -5.5, 6.5}};
  for (const char* text :
       {"1.5 2.5 3.5\n4.5 -5.5 6.5\n", "1.5,2.5,3.5\n4.5,-5.5,6.5",
        "1.5, 2.5, 3.5\n4.5, -5.5, 6.5\n", "1,5;2,5;3,5\n4,5;-5,5;6,5\n",
        "1,5 2,5 3,5\n4,5 -5,5 6,5\n", "1.5\t2.5\t3.5\n4.5\t-5.5\t6.5\n",
        "# made\n\nX Y Z\n1.5 2.5 3.5\n4.5 -5.5 6.5\n",
        "//X,Y,Z\r\n1.5,2.5,3.5\r\n4.5,-5.5,6.5\r\n", "2\n1.5 2.5 3.5 9 9\n+4.5 -5.5 6.5 9 9\n",
        "intensity,z,\"y\",x\n9,3.5,2.5,1.5\n9,6.5,-5.5,4.5\n"}) {
    SCOPED_TRACE(text);
    expect_positions(read_cloud_of(text, ".xyz"), two);
  }
  const auto swapped =
      read_cloud_of("some words\n9 2.5 1.5 3.5 0 0 1 2\n", ".txt", {"- y x z nx ny nz class"});
  expect_positions(swapped, {two[0]});
  EXPECT_EQ(swapped[0].normal, Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(swapped[0].classification, 2);
}

TEST(TextCloud, WhatIsWrongIsSaid) {
  EXPECT_THAT(refusal_of_cloud("1 2 3\n4 5\n", ".xyz"),
              AllOf(HasSubstr("line 2"), HasSubstr("2 columns, and 3")));
  EXPECT_THAT(refusal_of_cloud("1 2 3\n4 5 six\n", ".xyz"),
              AllOf(HasSubstr("line 2"), HasSubstr("'six' is not a number")));
  EXPECT_THAT(refusal_of_cloud("a b c\n1 2 3\n", ".xyz"), HasSubstr("columns = \"x y z\""));
  EXPECT_THAT(refusal_of_cloud("x y z\nmore words\n1 2 3\n", ".xyz"), HasSubstr("line 2"));
  EXPECT_THAT(refusal_of_cloud("1 2 3\n", ".xyz", {"x y"}), HasSubstr("x, y and z"));
  EXPECT_THAT(refusal_of_cloud("1 2 3\n", ".las", {"x y z"}), HasSubstr("texts alone"));
  EXPECT_THAT(refusal_of_cloud("1 2 3\n", ".e57"), HasSubstr("expected .ply, .pcd"));
  EXPECT_TRUE(read_cloud_of("", ".xyz").empty());
}

// Longer than the blocks in which files are read.
TEST(StreamBytes, LinesAndWordsAcrossBlocks) {
  std::string text;
  const int lines = 70'000;
  for (int i = 0; i < lines; ++i)
    text += std::to_string(i) + " " + std::to_string(i % 7) + " 0.25 \n";
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "lapwing_stream_bytes.xyz";
  write_file_atomically(file, text);
  const auto reader = open_cloud(file);
  int count = 0;
  std::vector<CloudPoint> some(1000);
  for (std::size_t n = 0; (n = reader->read(some)) > 0;)
    for (std::size_t i = 0; i < n; ++i, ++count)
      ASSERT_EQ(some[i].position, Vector3d(count, count % 7, 0.25));
  EXPECT_EQ(count, lines);
  StreamBytes words{file};
  std::string_view word;
  int seen = 0;
  while (words.word(word)) ++seen;
  EXPECT_EQ(seen, 3 * lines);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace lapwing
