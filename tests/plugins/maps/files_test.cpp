// SPDX-License-Identifier: Apache-2.0
// Files of real maps in both backends, and OctoMap's own reader and writer beside ours.
#include <octomap/OcTree.h>

#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/random.h"
#include "framework/map/map_file.h"
#include "tests/plugins/maps/depth_frames.h"
#include "tests/plugins/maps/map_pair.h"

namespace lapwing {
namespace {

Value with_resolution(double resolution) {
  Value value = Value::map();
  value.set("resolution", resolution);
  return value;
}

std::string written_by_octomap(const std::string& ot) {
  std::istringstream in(ot);
  const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(in));
  if (!tree) return "";
  std::ostringstream out;
  tree->write(out);
  return out.str();
}

TEST(RealMap, LoadsEqualIntoBothBackends) {
  if (!data_folder()) GTEST_SKIP() << "no ../shared/data (LAPWING_DATA)";
  const MapFile file = read_map_file(*data_folder() / "maps/geb079.bt");
  EXPECT_EQ(file.resolution, 0.08);
  EXPECT_TRUE(file.two_states);
  const auto octomap = make_map("octomap", with_resolution(0.08));
  const auto brick = make_map("brick", with_resolution(0.08));
  octomap->import(file.leaves);
  brick->import(file.leaves);
  EXPECT_EQ(first_difference(*octomap, *brick), "");
  EXPECT_EQ(brick->bounds(), octomap->bounds());
  // The reading map's clamps.
  for (const VoxelLeaf& leaf : file.leaves) {
    const float expected =
        leaf.log_odds < 0 ? brick->settings().clamp_min : brick->settings().clamp_max;
    ASSERT_EQ(brick->read(leaf.key).log_odds, expected);
  }
  // OctoMap reads the same from the file itself.
  octomap::OcTree tree((*data_folder() / "maps/geb079.bt").string());
  std::uint64_t voxels = 0;
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    const octomap::OcTreeKey key = leaf.getIndexKey();
    ASSERT_EQ(brick->read({key[0], key[1], key[2]}).log_odds, leaf->getLogOdds());
    voxels += std::uint64_t{1} << 3 * (16 - leaf.getDepth());
  }
  EXPECT_EQ(voxels, brick->counts().known);
  EXPECT_TRUE(map_file_bytes(".bt", *octomap) == map_file_bytes(".bt", *brick));
  const MapFile again = parse_map(map_file_bytes(".bt", *brick), "again");
  const auto third = make_map("brick", with_resolution(0.08));
  third->import(again.leaves);
  EXPECT_EQ(first_difference(*third, *brick), "");
}

TEST(Files, AreOctomapsToTheByte) {
  const auto map = make_map("brick", with_resolution(0.1));
  Random random(8);
  for (int scan = 0; scan < 8; ++scan) {
    std::vector<Eigen::Vector3f> points;
    for (int k = 0; k < 200; ++k)
      points.push_back(
          Eigen::Vector3d(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-2, 2))
              .cast<float>());
    map->integrate(points, {0.05f, 0.05f, 0.05f});
  }
  map->import(std::vector<VoxelLeaf>{{{32704, 32704, 32704}, 5, 0, -1.0f}});
  const std::string bytes = map_file_bytes(".ot", *map);
  EXPECT_TRUE(written_by_octomap(bytes) == bytes);
}

class Memory : public testing::TestWithParam<const char*> {};

TEST_P(Memory, ALimitRefusesAndChangesNothing) {
  Value value = with_resolution(0.05);
  value.set("memory_limit", 16);
  value.set("observations", true);
  const auto map = make_map(GetParam(), value);
  std::vector<Eigen::Vector3f> points;
  Random random(3);
  for (int k = 0; k < 900; ++k)
    points.push_back(Eigen::Vector3d(random.normal(), random.normal(), random.normal())
                         .normalized()
                         .cast<float>() *
                     30.0f);
  const std::vector<Eigen::Vector3f> few(points.begin(), points.begin() + 5);
  map->integrate(few, {0, 0, 0});
  const std::vector<VoxelLeaf> before = voxels_of(*map);
  const auto refused = [&](const std::function<void()>& call) {
    try {
      call();
      FAIL() << "taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("memory_limit"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(voxels_of(*map) == before);
    EXPECT_LT(map->bytes(), std::size_t{16} << 20);
  };
  refused([&] { map->integrate(points, {0, 0, 0}); });
  // What is one node of a tree is many bricks.
  if (GetParam() == std::string("brick"))
    refused([&] { map->import(std::vector<VoxelLeaf>{{{0, 0, 0}, 12, 0, -1.0f}}); });
  std::vector<VoxelLeaf> many;
  for (int k = 0; k < 30000; ++k)
    many.push_back({{static_cast<std::uint16_t>(random.integer(0, 65535)),
                     static_cast<std::uint16_t>(random.integer(0, 65535)),
                     static_cast<std::uint16_t>(random.integer(0, 65535))},
                    0,
                    1,
                    -1.0f});
  refused([&] { map->import(many); });
  // The map still works.
  map->integrate(few, {0, 0, 0});
  EXPECT_GT(voxels_of(*map).size(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Backends, Memory, testing::Values("brick", "octomap"));

}  // namespace
}  // namespace lapwing
