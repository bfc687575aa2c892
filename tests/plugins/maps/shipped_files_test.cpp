// SPDX-License-Identifier: Apache-2.0
// The map and the depth images of tests/data in both backends, and in OctoMap itself.
#include <octomap/OcTree.h>

#include "framework/geometry/depth_folder.h"
#include "framework/map/map_file.h"
#include "tests/plugins/maps/map_pair.h"

#include <gtest/gtest.h>

namespace lapwing {
namespace {

const std::string kShipped = LAPWING_SOURCE_DIR "/tests/data";

Value settings(double resolution) {
  Value value = Value::map();
  value.set("resolution", resolution);
  return value;
}

TEST(ShippedMap, LoadsEqualIntoBothBackendsAndOctoMap) {
  const MapFile file = read_map_file(kShipped + "/maps/room.bt");
  EXPECT_EQ(file.resolution, 0.2);
  EXPECT_TRUE(file.two_states);
  const auto octomap = make_map("octomap", settings(0.2));
  const auto brick = make_map("brick", settings(0.2));
  octomap->import(file.leaves);
  brick->import(file.leaves);
  EXPECT_EQ(first_difference(*octomap, *brick), "");
  octomap::OcTree tree(kShipped + "/maps/room.bt");
  std::uint64_t voxels = 0;
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    const octomap::OcTreeKey key = leaf.getIndexKey();
    ASSERT_EQ(brick->read({key[0], key[1], key[2]}).log_odds, leaf->getLogOdds());
    voxels += std::uint64_t{1} << 3 * (16 - leaf.getDepth());
  }
  EXPECT_EQ(voxels, brick->counts().known);
  EXPECT_EQ(voxels, 6960u + 3263u);
  const MapFile again = parse_map(map_file_bytes(".bt", *brick), "again");
  const auto third = make_map("brick", settings(0.2));
  third->import(again.leaves);
  EXPECT_EQ(first_difference(*third, *brick), "");
}

TEST(ShippedMap, FramesGiveEqualMaps) {
  const DepthFolder folder(kShipped + "/depth");
  for (const char* mode : {"exact", "discretised"}) {
    Value value = settings(0.1);
    value.set("mode", mode);
    value.set("observations", true);
    const auto octomap = make_map("octomap", value), brick = make_map("brick", value);
    for (std::size_t k = 0; k < folder.size(); ++k) {
      octomap->integrate(folder.read(k));
      brick->integrate(folder.read(k));
    }
    EXPECT_EQ(first_difference(*octomap, *brick), "") << mode;
    EXPECT_GT(brick->counts().occupied, 1000u) << mode;
  }
}

}  // namespace
}  // namespace lapwing
