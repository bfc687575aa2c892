// SPDX-License-Identifier: Apache-2.0
// The program asked about the maps of an exploration: of one that was planned, of one that is being
// planned, of a run's folder. All is compared with the map that `lapwing run` writes.
#include <map>

#include <gmock/gmock.h>

#include "framework/map/map_file.h"
#include "tests/studio/kinds_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

class StudioExplored : public StudioAsked {
 protected:
  void open(const std::vector<std::string>& options) {
    use("explore/city.lua");
    open_page(options);
  }
  Value slice(const std::string& axis, double at, int image, const std::string& more = "") {
    Value answer = ask(R"("type": "slice", "axis": ")" + axis + R"(", "at": )" +
                       std::to_string(at) + R"(, "image": )" + std::to_string(image) + more);
    EXPECT_EQ(answer.at("type"), Value("slice")) << to_json(answer);
    return answer;
  }
  Value voxel(const Eigen::Vector3d& p, int image, const std::string& more = "") {
    Value answer = ask(R"("type": "voxel", "position": [)" + std::to_string(p.x()) + "," +
                       std::to_string(p.y()) + "," + std::to_string(p.z()) + R"(], "image": )" +
                       std::to_string(image) + more);
    EXPECT_EQ(answer.at("type"), Value("voxel")) << to_json(answer);
    return answer;
  }
  void compare_slice();
  void compare_voxels();
};

// Every cell of a slice at the end.
void StudioExplored::compare_slice() {
  const Value& view = world_.at("exploration").at("images").as_list()[5].at("position");
  const Value at_end = slice("z", view.as_list()[2].as_number(), 6);
  EXPECT_EQ(at_end.at("level"), Value(0));
  EXPECT_EQ(at_end.at("image"), Value(6));
  const std::string cells = blob(*address_, at_end.at("cells"));
  const auto columns = static_cast<std::size_t>(at_end.at("columns").as_integer()),
             rows = static_cast<std::size_t>(at_end.at("rows").as_integer());
  const double edge = at_end.at("edge").as_number();
  const VoxelGrid grid(edge);
  const auto layer = grid.key({0, 0, at_end.at("at").as_number()}).z;
  std::map<std::array<int, 2>, float> known;
  for (const VoxelLeaf& leaf : map_.leaves) {
    const int size = 1 << leaf.level;
    if (layer < leaf.key.z || layer >= leaf.key.z + size) continue;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) known[{leaf.key.x + x, leaf.key.y + y}] = leaf.log_odds;
  }
  const double low = at_end.at("clamps").as_list()[0].as_number(),
               high = at_end.at("clamps").as_list()[1].as_number();
  const auto lower = at_end.at("lower").as_list();
  std::size_t found = 0;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const VoxelKey key =
          grid.key({lower[0].as_number() + (static_cast<double>(column) + 0.5) * edge,
                    lower[1].as_number() + (static_cast<double>(row) + 0.5) * edge, 0});
      const auto here = known.find({key.x, key.y});
      const std::size_t place = row * columns + column;
      ASSERT_EQ(cells.at(12 + columns * rows + place) != 0, here != known.end());
      if (here == known.end()) continue;
      ++found;
      ASSERT_NEAR(static_cast<unsigned char>(cells[12 + place]),
                  255 * (here->second - low) / (high - low), 0.51);
    }
  EXPECT_EQ(found, known.size());
  EXPECT_GT(found, 100u);
  // Beyond the map it is the last layer; before the first image the box at the start.
  EXPECT_EQ(slice("z", 1e4, 6).at("at"), at_end.at("extent").as_list()[1]);
  const Value at_start = slice("z", 0, 0);
  EXPECT_EQ(at_start.at("counts").at("occupied"), Value(0));
  EXPECT_LT(at_start.at("columns").as_integer(), at_end.at("columns").as_integer());
}

// Voxels that grew: their numbers at the end are those of the map; each is occupied after the image
// of its growth and not before.
void StudioExplored::compare_voxels() {
  const std::string growth = blob(*address_, world_.at("exploration").at("growth"));
  const std::size_t count = (growth.size() - 12) / 16;
  ASSERT_GT(count, 100u);
  for (std::size_t k = 5; k < count; k += count / 12) {
    float middle[3];
    std::uint32_t image = 0;
    std::memcpy(middle, growth.data() + 12 + 16 * k, sizeof middle);
    std::memcpy(&image, growth.data() + 24 + 16 * k, sizeof image);
    const Eigen::Vector3d p = Eigen::Map<Eigen::Vector3f>(middle).cast<double>();
    const Value at_end = voxel(p, 6);
    const auto leaf = written(VoxelGrid(at_end.at("edge").as_number()).key(p));
    ASSERT_TRUE(leaf);
    EXPECT_EQ(at_end.at("state"), Value("occupied"));
    EXPECT_EQ(at_end.at("log_odds").as_number(), leaf->log_odds);
    EXPECT_GT(at_end.at("observations").as_integer(), 0);
    const auto grew = static_cast<int>(image);
    EXPECT_EQ(voxel(p, grew).at("state"), Value("occupied"));
    const Value before = voxel(p, grew - 1);
    EXPECT_NE(before.at("state"), Value("occupied"));
    const std::int64_t known = at_end.at("known_from").as_integer();
    EXPECT_LE(known, grew);
    EXPECT_EQ(before.at("known_from").is_null(), known > grew - 1);
    EXPECT_NE(voxel(p, static_cast<int>(known)).at("state"), Value("unknown"));
    EXPECT_TRUE(known == 0 ||
                voxel(p, static_cast<int>(known) - 1).at("state") == Value("unknown"));
  }
  // Where the flight begins it was taken to be free.
  const Value& start = world_.at("exploration").at("images").as_list()[0].at("position");
  const Value first = voxel({start.as_list()[0].as_number(), start.as_list()[1].as_number(),
                             start.as_list()[2].as_number()},
                            0);
  EXPECT_EQ(first.at("state"), Value("free"));
  EXPECT_EQ(first.at("known_from"), Value(0));
  EXPECT_EQ(first.at("observations"), Value(0));
}

TEST_F(StudioExplored, MapsOfThePlanAndOfItsRunAreThoseThatTheRunWrote) {
  open({"--set", "steps=6"});
  EXPECT_EQ(run({"run", script_.string(), "--set", "steps=6"}), 0) << errors_;
  map_ = read_map_file(folder_ / "out/explore_city/map.ot");
  compare_slice();
  compare_voxels();
  // The run's folder says the same: its images are taken again.
  const std::string of_run = R"(, "folder": "explore_city")";
  for (const int image : {6, 2, 5}) {
    Value own = slice("x", 3, image), run = slice("x", 3, image, of_run);
    EXPECT_EQ(run, own);
    EXPECT_EQ(voxel({3, 4, 1}, image, of_run), voxel({3, 4, 1}, image));
  }
  // What cannot be answered.
  EXPECT_THAT(why(R"("type": "slice", "axis": "x", "at": 1)"), HasSubstr("image: missing"));
  EXPECT_THAT(why(R"("type": "slice", "axis": "x", "at": 1, "image": 7)"),
              HasSubstr("there is no image 7; expected 0 (before the first) to 6"));
  EXPECT_THAT(why(R"("type": "left_out")"), HasSubstr("no map of a first flight"));
  EXPECT_THAT(why(R"("type": "voxel", "ray": [0, 0, 500, 0, 0, 1], "image": 6)"),
              HasSubstr("no occupied voxel"));
  EXPECT_THAT(why(R"("type": "slice", "axis": "x", "at": 1, "image": 1, "folder": "none")"),
              HasSubstr("none"));
  // A run that this studio does not repeat: its camera had the noise of another seed.
  EXPECT_EQ(run({"run", script_.string(), "--set", "steps=2", "--set", "camera.sigma=0.2", "--seed",
                 "9", "-o", "out/other"}),
            0)
      << errors_;
  EXPECT_THAT(why(R"("type": "slice", "axis": "x", "at": 1, "image": 1, "folder": "other")"),
              HasSubstr("do not give the map of the run"));
}

// While it waits after an image, its map is that of the finished exploration after this image.
TEST_F(StudioExplored, TheMapOfAnExplorationThatIsBeingPlanned) {
  open({"--set", "steps=12"});
  std::map<int, Value> finished;
  for (int image = 0; image <= 12; ++image) finished[image] = slice("z", 4, image);
  plan_paused(*page_, 60);
  for (const int image : {1, 0}) EXPECT_EQ(slice("z", 4, image), finished[image]) << image;
  EXPECT_THAT(why(R"("type": "slice", "axis": "x", "at": 1, "image": 2)"),
              HasSubstr("there is no image 2; expected 0 (before the first) to 1"));
  const Value known = voxel({0, 0, 4}, 1);
  ASSERT_TRUE(page_->send_text(R"({"type": "undo", "id": "u", "base": 2})"));
  page_->until_judged(3);
  EXPECT_EQ(voxel({0, 0, 4}, 1), known);
  for (const int image : {12, 5}) EXPECT_EQ(slice("z", 4, image), finished[image]) << image;
}

}  // namespace
}  // namespace lapwing
