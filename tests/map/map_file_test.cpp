// SPDX-License-Identifier: Apache-2.0
#include "framework/map/map_file.h"

#include <cstring>
#include <filesystem>

#include "framework/core/files.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

std::string header(const char* kind, const std::string& lines) {
  return std::string("# Octomap OcTree ") + kind + "\n" + lines + "data\n";
}
const std::string kLines = "id OcTree\nsize 2\nres 0.1\n";

std::string node(float value, int children) {
  std::string bytes(5, '\0');
  std::memcpy(bytes.data(), &value, 4);
  bytes[4] = static_cast<char>(children);
  return bytes;
}

// What reading says of the bytes; "" when it reads them.
std::string complaint(const std::string& bytes) {
  try {
    parse_map(bytes, "x.bt");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(MapFile, ReadsTwoStatesByHand) {
  // The root has an occupied child 0 and a free child 7: eight cubes of 32768^3 voxels.
  const MapFile file =
      parse_map(header("binary file", "# a comment\nid OcTree\nsize 3\nres 0.1\n") +
                    std::string("\x02\x40", 2),
                "x.bt");
  EXPECT_EQ(file.resolution, 0.1);
  EXPECT_TRUE(file.two_states);
  const std::vector<VoxelLeaf> leaves{{{0, 0, 0}, 15, 0, HUGE_VALF},
                                      {{32768, 32768, 32768}, 15, 0, -HUGE_VALF}};
  EXPECT_EQ(file.leaves, leaves);
}

TEST(MapFile, ReadsLogOddsByHandAndLeavesColoursOut) {
  const MapFile file =
      parse_map(header("file", kLines) + node(0.5f, 0x10) + node(-1.25f, 0), "x.ot");
  const std::vector<VoxelLeaf> leaves{{{0, 0, 32768}, 15, 0, -1.25f}};
  EXPECT_EQ(file.leaves, leaves);
  EXPECT_FALSE(file.two_states);
  const auto colored = [](float value, int children) {
    return node(value, 0).substr(0, 4) + "rgb" + static_cast<char>(children);
  };
  const MapFile same = parse_map(header("file", "id ColorOcTree\nsize 2\nres 0.1\n") +
                                     colored(0.5f, 0x10) + colored(-1.25f, 0),
                                 "x.ot");
  EXPECT_EQ(same.leaves, leaves);
}

TEST(MapFile, WhatIsWrittenIsRead) {
  SmallMap map(0.25);
  std::vector<VoxelLeaf> leaves;
  for (int k = 0; k < 500; ++k)
    leaves.push_back(
        {{static_cast<std::uint16_t>(32700 + k % 11 * 13),
          static_cast<std::uint16_t>(32768 + k % 7), static_cast<std::uint16_t>(32760 + k % 31)},
         0,
         0,
         k % 3 ? -2.0f : 0.01f * k});
  leaves.push_back({{32704, 32704, 32704}, 3, 0, -1.5f});  // eight equal children are one
  map.import(leaves);
  const MapFile file = parse_map(map_file_bytes(".ot", map), "x.ot");
  EXPECT_EQ(file.resolution, 0.25);
  SmallMap again(0.25);
  again.import(file.leaves);
  EXPECT_TRUE(map_file_bytes(".ot", again) == map_file_bytes(".ot", map));
  bool merged = false;
  for (const VoxelLeaf& leaf : file.leaves) merged |= leaf.level == 3;
  EXPECT_TRUE(merged);
  EXPECT_EQ(again.counts().known, map.counts().known);
}

TEST(MapFile, TwoStatesLeaveOutWhatIsInBetween) {
  SmallMap map;
  map.import(std::vector<VoxelLeaf>{
      {{7, 7, 7}, 0, 0, -2.0f}, {{8, 8, 8}, 0, 0, 0.5f}, {{9, 9, 9}, 0, 0, 2.0f}});
  const MapFile file = parse_map(map_file_bytes(".bt", map), "x.bt");
  const std::vector<VoxelLeaf> leaves{{{7, 7, 7}, 0, 0, -HUGE_VALF}, {{9, 9, 9}, 0, 0, HUGE_VALF}};
  EXPECT_EQ(file.leaves, leaves);
}

TEST(MapFile, AnEmptyMapAndAFullOne) {
  const SmallMap empty;
  for (const char* ending : {".bt", ".ot"})
    EXPECT_TRUE(parse_map(map_file_bytes(ending, empty), "x").leaves.empty());
}

TEST(MapFile, PointsAreTheMiddlesOfOccupiedVoxels) {
  SmallMap map(0.5);
  map.import(std::vector<VoxelLeaf>{{{32768, 32769, 32767}, 0, 0, 3.0f},
                                    {{32770, 32769, 32767}, 0, 0, -2.0f}});
  const std::string ply = map_file_bytes(".ply", map);
  EXPECT_NE(ply.find("element vertex 1\n"), ply.npos);
  float numbers[4];
  const std::size_t at = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size() - at, sizeof numbers);
  std::memcpy(numbers, ply.data() + at, sizeof numbers);
  EXPECT_EQ(numbers[0], 0.25f);
  EXPECT_EQ(numbers[1], 0.75f);
  EXPECT_EQ(numbers[2], -0.25f);
  EXPECT_EQ(numbers[3], 3.0f);
}

TEST(MapFile, HostileFilesAreRefusedWithTheReason) {
  const auto says = [](const std::string& bytes, const std::string& part) {
    const std::string text = complaint(bytes);
    EXPECT_EQ(text.rfind("x.bt: the map ", 0), 0u) << text;
    EXPECT_NE(text.find(part), text.npos) << text << " lacks " << part;
  };
  const std::string two = std::string("\x02\x40", 2);
  says("", "header");
  says("PNG\n", "not an OctoMap file");
  says(header("binary file", "size 3\nres 0.1\n") + two, "no line 'id'");
  says(header("binary file", "id OcTree\nres 0.1\n") + two, "no line 'size'");
  says(header("binary file", "id OcTree\nsize 3\n") + two, "no line 'res'");
  says(header("binary file", "id Stamped\nsize 3\nres 0.1\n") + two, "OcTree and ColorOcTree");
  says(header("binary file", "id OcTree\nsize -3\nres 0.1\n") + two, "'-3'");
  for (const char* resolution : {"nan", "0", "-0.1", "inf", "1e300", "x", "0.1m"})
    says(header("binary file", std::string("id OcTree\nsize 3\nres ") + resolution + "\n") + two,
         "resolution");
  says(header("binary file", "id OcTree\nsize 3\nres 0.1\nhue 3\n") + two, "hue");
  says(header("binary file", "id OcTree\nsize 4294967296\nres 0.1\n") + two, "cut off");
  says(header("file", "id OcTree\nsize 4294967296\nres 0.1\n") + two, "cut off");
  says(header("binary file", "id OcTree\nsize 3\nres 0.1\n") + std::string("\x02", 1), "cut off");
  says(header("binary file", "id OcTree\nsize 4\nres 0.1\n") + two, "but holds 3");
  says(header("binary file", "id OcTree\nsize 3\nres 0.1\n") + two + "more", "goes on for 4 bytes");
  says(header("binary file", "id OcTree\nsize 1\nres 0.1\n") + std::string(2, '\0'),
       "without children");
  says(header("file", kLines) + node(NAN, 1) + node(0, 0), "not a finite number");
  std::string deep = header("file", "id OcTree\nsize 18\nres 0.1\n");
  for (int k = 0; k < 18; ++k) deep += node(0, k < 17);
  says(deep, "16th level");
  std::string chain = header("binary file", "id OcTree\nsize 20\nres 0.1\n");
  for (int k = 0; k < 20; ++k) chain += std::string("\x03\x00", 2);
  says(chain, "16th level");
}

TEST(MapFile, EveryCutIsNoticed) {
  SmallMap map;
  map.import(std::vector<VoxelLeaf>{{{7, 7, 7}, 0, 0, -2.0f}, {{900, 8, 8}, 0, 0, 2.0f}});
  for (const char* ending : {".bt", ".ot"}) {
    const std::string bytes = map_file_bytes(ending, map);
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_NE(complaint(bytes.substr(0, size)), "") << ending << " " << size;
  }
}

// Of 2 GiB, of which the file system holds one page: the sizes are told, and nothing of it is read.
TEST(MapFile, ALargerOneThanCanBeHeldIsRefusedWithTheLargest) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "lapwing_large_map.bt";
  SmallMap map;
  map.import(std::vector<VoxelLeaf>{{{7, 7, 7}, 0, 0, -2.0f}});
  write_map_file(path, map);
  std::filesystem::resize_file(path, std::uintmax_t{2} << 30);
  try {
    read_map_file(path);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), path.string() +
                                ": the map has 2147483648 bytes, and the largest that can be read "
                                "has 1073741824: cut it to the region of the flight, or make it "
                                "with larger voxels");
  }
  std::filesystem::remove(path);
}

TEST(MapFile, WritingIsWholeOrNotAtAll) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "lapwing_map_file";
  std::filesystem::remove_all(folder);
  SmallMap map;
  map.import(std::vector<VoxelLeaf>{{{7, 7, 7}, 0, 0, -2.0f}});
  write_map_file(folder / "a.ot", map);
  EXPECT_EQ(read_map_file(folder / "a.ot").leaves.size(), 1u);
  EXPECT_THROW(write_map_file(folder / "a.pcd", map), InputError);
  EXPECT_THROW(write_map_file(folder / "a.ot" / "b.ot", map), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lapwing
