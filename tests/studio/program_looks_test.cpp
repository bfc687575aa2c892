// SPDX-License-Identifier: Apache-2.0
// The program asked about a planned scan: voxels, slices of the map, places that were left out,
// views. All is compared with what `lapwing run` writes.
#include <map>

#include <gmock/gmock.h>

#include "framework/map/map_file.h"
#include "tests/studio/kinds_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kOptions{
    "--config", "scan/small",
    "--set",    "resolution=1",
    "--set",    "tour.budget=90",
    "--set",    "map={type: brick, observations: true}",
    "--set",    "forbidden=[{position: [0, 25, 30], within: 15}]"};

class StudioLooks : public StudioAsked {
 protected:
  void open() {
    use("scan/church.lua");
    revision_ = open_page(kOptions).at("revision").as_integer();
  }
  void fly() {
    std::vector<std::string> words{"run", script_.string(), "-o", "flown"};
    words.insert(words.end(), kOptions.begin(), kOptions.end());
    EXPECT_EQ(run(words), 0) << errors_;
    map_ = read_map_file(folder_ / "flown/map.ot");
  }
  static VoxelKey key_of(const Value& voxel) {
    const Value::List& key = voxel.at("key").as_list();
    return {static_cast<std::uint16_t>(key[0].as_integer()),
            static_cast<std::uint16_t>(key[1].as_integer()),
            static_cast<std::uint16_t>(key[2].as_integer())};
  }
  static std::uint32_t number_at(const std::string& bytes, std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
  }
  static float float_at(const std::string& bytes, std::size_t at) {
    float number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
  }

  void ask_voxels();
  void ask_slices();
  void ask_left_out();
  void ask_views();
  void ask_while_planning();

  std::int64_t revision_ = 0;
};

// A voxel is what the map of the run says, seen by images of the tour.
void StudioLooks::ask_voxels() {
  const Value::List& views = world_.at("scan").at("views").as_list();
  std::size_t images = 0;
  for (const char* ray :
       {"[0, 0, 200, 0, 0, -1]", "[-3, 6, 150, 0, 0.01, -1]", "[90, 80, 60, -0.9, -0.8, -0.5]",
        "[4, -60, 10, 0, 1, -0.05]", "[0, 70, 60, 0, -0.9, -0.5]", "[-60, 0, 60, 0.8, 0, -0.6]"}) {
    const Value voxel = ask(std::string(R"("type": "voxel", "ray": )") + ray);
    ASSERT_EQ(voxel.at("type"), Value("voxel")) << to_json(voxel);
    EXPECT_EQ(voxel.at("state"), Value("occupied"));
    const auto odds = written(key_of(voxel));
    ASSERT_TRUE(odds);
    EXPECT_EQ(voxel.at("log_odds").as_number(), odds->log_odds);
    EXPECT_GT(voxel.at("observations").as_integer(), 0);
    const Value::List& middle = voxel.at("middle").as_list();
    double sum = 0;
    for (const Value& image : voxel.at("images").as_list()) {
      const auto number = static_cast<std::size_t>(image.at("number").as_integer());
      ASSERT_GE(number, 1u);
      ASSERT_LE(number, views.size());
      double squares = 0;
      for (std::size_t i = 0; i < 3; ++i)
        squares += std::pow(
            views[number - 1].at("position").as_list()[i].as_number() - middle[i].as_number(), 2);
      EXPECT_NEAR(image.at("distance").as_number(), std::sqrt(squares), 1e-4);
      EXPECT_NEAR(
          image.at("mm_per_pixel").as_number(),
          1000 * std::sqrt(squares) / world_.at("scan").at("image").as_list()[2].as_number(), 1e-3);
      sum += image.at("told").as_number();
      ++images;
    }
    EXPECT_NEAR(voxel.at("share").as_number(), std::min(1.0, sum), 1e-5);
    // The place in its middle is the same voxel.
    Value again = ask(R"("type": "voxel", "position": )" + to_json(voxel.at("middle"), -1));
    EXPECT_EQ(again, voxel);
  }
  EXPECT_GT(images, 0u);
  EXPECT_EQ(ask(R"("type": "voxel", "position": [0, 0, 500])").at("state"), Value("unknown"));
  EXPECT_THAT(why(R"("type": "voxel", "ray": [0, 0, 200, 0, 0, 1])"),
              HasSubstr("no occupied voxel lies there"));
  EXPECT_THAT(why(R"("type": "voxel", "ray": [0, 0, 200, 0, 0, 0])"), HasSubstr("no length"));
  EXPECT_THAT(why(R"("type": "voxel", "position": [0, 0, 1e6])"), HasSubstr("32768 m"));
}

// A slice is a layer of the map of the run.
void StudioLooks::ask_slices() {
  const Value& extent = world_.at("scan").at("map");
  const Value slice = ask(R"("type": "slice", "axis": "z", "at": 2.3)");
  ASSERT_EQ(slice.at("type"), Value("slice")) << to_json(slice);
  EXPECT_EQ(slice.at("at"), Value(2.5));
  EXPECT_EQ(slice.at("lower").as_list()[0], extent.at("lower").as_list()[0]);
  const std::string cells = blob(*address_, slice.at("cells"));
  ASSERT_EQ(cells.substr(0, 4), "WLS1");
  const std::size_t columns = number_at(cells, 4), rows = number_at(cells, 8),
                    count = columns * rows;
  ASSERT_EQ(cells.size(), 12 + 2 * count);
  EXPECT_EQ(slice.at("columns").as_integer(), static_cast<std::int64_t>(columns));
  const double low = slice.at("clamps").as_list()[0].as_number(),
               high = slice.at("clamps").as_list()[1].as_number();
  const VoxelGrid grid(1);
  std::int64_t counts[4] = {};
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t place = row * columns + column;
      const auto state = static_cast<unsigned char>(cells[12 + count + place]);
      ASSERT_LT(state, 4);
      ++counts[state];
      if ((row * 7 + column) % 23 != 0) continue;
      const auto odds = written(grid.key(
          {slice.at("lower").as_list()[0].as_number() + static_cast<double>(column) + 0.5,
           slice.at("lower").as_list()[1].as_number() + static_cast<double>(row) + 0.5, 2.5}));
      ASSERT_EQ(odds.has_value(), state != 0);
      if (odds)
        EXPECT_NEAR(static_cast<unsigned char>(cells[12 + place]),
                    255 * (odds->log_odds - low) / (high - low), 0.51);
    }
  const Value& told_counts = slice.at("counts");
  EXPECT_EQ(told_counts.at("unknown"), Value(counts[0]));
  EXPECT_EQ(told_counts.at("free"), Value(counts[1]));
  EXPECT_EQ(told_counts.at("occupied"), Value(counts[2]));
  EXPECT_GT(counts[1], 0);
  EXPECT_GT(counts[2], 0);
  EXPECT_THAT(why(R"("type": "slice", "axis": "z", "at": 999)"),
              HasSubstr("z = 999 m lies outside of the map, which reaches from"));
}

// Places that were left out have reasons, whose counts are right.
void StudioLooks::ask_left_out() {
  const Value left = ask(R"("type": "left_out")");
  ASSERT_EQ(left.at("type"), Value("left_out")) << to_json(left);
  const std::string places = blob(*address_, left.at("places"));
  ASSERT_EQ(places.substr(0, 4), "WLL1");
  const std::size_t count = number_at(places, 4);
  ASSERT_EQ(places.size(), 8 + 16 * count);
  const Value::List& reasons = left.at("reasons").as_list();
  std::vector<std::int64_t> counts(reasons.size(), 0);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t reason = number_at(places, 8 + 16 * k + 12);
    ASSERT_LT(reason, reasons.size());
    ++counts[reason];
    if (reasons[reason].at("reason") != Value("forbidden")) continue;
    EXPECT_LE(Eigen::Vector3d(float_at(places, 8 + 16 * k), float_at(places, 12 + 16 * k) - 25,
                              float_at(places, 16 + 16 * k) - 30)
                  .norm(),
              15.001);
  }
  std::map<std::string, std::int64_t> by_name;
  for (std::size_t k = 0; k < reasons.size(); ++k) {
    EXPECT_EQ(reasons[k].at("count"), Value(counts[k]));
    by_name[reasons[k].at("reason").as_text()] = counts[k];
  }
  for (const char* name : {"obstacle", "outside", "forbidden", "not_chosen"})
    EXPECT_GT(by_name[name], 0) << name;
  // The candidates among them are all those that are not in the tour.
  const std::int64_t candidates =
      by_name["nothing"] + by_name["apart"] + by_name["budget"] + by_name["not_chosen"];
  const std::int64_t all =
      static_cast<std::int64_t>(world_.at("scan").at("candidates").as_list().size());
  EXPECT_EQ(candidates + static_cast<std::int64_t>(world_.at("scan").at("views").as_list().size()),
            all);
}

// A view has its ways, its voxels and its image.
void StudioLooks::ask_views() {
  const Value::List& views = world_.at("scan").at("views").as_list();
  const Value image = ask(R"("type": "view", "image": 1)");
  ASSERT_EQ(image.at("type"), Value("view")) << to_json(image);
  EXPECT_EQ(image.at("position"), views[1].at("position"));
  EXPECT_EQ(image.at("yaw"), views[1].at("yaw"));
  const std::string number = std::to_string(image.at("candidate").as_integer());
  Value candidate = ask(R"("type": "view", "candidate": )" + number);
  EXPECT_EQ(candidate, image);
  const Value& scan = world_.at("scan");
  const auto place = static_cast<std::size_t>(image.at("candidate").as_integer());
  EXPECT_EQ(image.at("score"), scan.at("candidate_scores").as_list()[place]);
  EXPECT_EQ(image.at("position"), scan.at("candidates").as_list()[place]);
  ASSERT_FALSE(image.at("ways").as_list().empty());
  for (const Value& way : image.at("ways").as_list()) {
    EXPECT_EQ(way.at("points").as_list().front(), image.at("position"));
    EXPECT_EQ(way.at("points").as_list().back(),
              scan.at("candidates")
                  .as_list()[static_cast<std::size_t>(way.at("candidate").as_integer())]);
    EXPECT_GT(way.at("seconds").as_number(), 0);
  }
  const std::string voxels = blob(*address_, image.at("told"));
  ASSERT_EQ(voxels.substr(0, 4), "WLV1");
  EXPECT_EQ(number_at(voxels, 4), static_cast<std::uint32_t>(image.at("voxels").as_integer()));
  EXPECT_EQ(voxels.size(), 12 + 16 * std::size_t{number_at(voxels, 4)});
  EXPECT_EQ(float_at(voxels, 8), 1);
  double sum = 0;
  for (std::size_t at = 12; at < voxels.size(); at += 16) sum += float_at(voxels, at + 12);
  EXPECT_NEAR(sum, image.at("score").as_number(), 1e-3 * sum);
  EXPECT_EQ(blob(*address_, image.at("picture")).substr(1, 3), "PNG");
  EXPECT_THAT(why(R"("type": "view", "candidate": 150)"), HasSubstr("expected 0 to 149"));
  EXPECT_THAT(why(R"("type": "view", "image": 9999)"), HasSubstr("expected 0 to"));
  EXPECT_THAT(why(R"("type": "view", "image": 0, "tour": 3)"), HasSubstr("tour"));
}

// While a plan is under way the one on display is asked about; undo comes back to its map.
void StudioLooks::ask_while_planning() {
  const std::string question = R"("type": "voxel", "ray": [0, 0, 200, 0, 0, -1])";
  const Value before = ask(question);
  page_->send_text(R"({"type": "gesture", "id": "g", "label": "fewer",
                       "patch": [{"path": "candidates.most", "value": 100}], "base": )" +
                   std::to_string(revision_) + "}");
  page_->until_type("document");
  const auto asked = std::chrono::steady_clock::now();
  EXPECT_EQ(ask(question), before);
  const auto waited = std::chrono::steady_clock::now() - asked;
  page_->until_judged(revision_ + 1);
  EXPECT_LT(waited, std::chrono::steady_clock::now() - asked);
  EXPECT_THAT(why(R"("type": "view", "candidate": 100)"), HasSubstr("expected 0 to 99"));
  page_->send_text(R"({"type": "undo", "id": "u", "base": )" + std::to_string(revision_ + 1) + "}");
  page_->until_judged(revision_ + 2);
  EXPECT_EQ(ask(question), before);
}

TEST_F(StudioLooks, AllThatIsAskedIsWhatTheRunHas) {
  open();
  fly();
  ask_voxels();
  ask_slices();
  ask_left_out();
  ask_views();
  ask_while_planning();
}

// Of a pattern that is edited the images are told before they are flown: those that then are.
TEST_F(StudioLooks, AFirstFlightIsDrawnBeforeItIsFlown) {
  open();
  const auto told_flight = [&] {
    return page_->until([](const Value& m) {
      return m.at("type") == Value("first_flight") || m.at("type") == Value("refused");
    });
  };
  const std::string patch = R"([{"path": "flights", "value": [
      {"pattern": "ellipse", "views": 20, "reach": 12, "pitch_deg": -40},
      {"pattern": "meander", "views": 12, "reach": 5, "height": 65, "pitch_deg": -90}]}])";
  page_->send_text(R"({"type": "preview", "edit": 5, "patch": )" + patch + "}");
  const Value dragged = told_flight();
  ASSERT_EQ(dragged.at("type"), Value("first_flight")) << to_json(dragged);
  EXPECT_EQ(dragged.at("edit"), Value(std::int64_t{5}));
  EXPECT_EQ(dragged.at("tab"), Value("a"));
  ASSERT_EQ(dragged.at("images").as_list().size(), 32u);
  // The camera looks straight down: a rectangle of 600 by 450 pixels.
  const double high = 65 - dragged.at("level").as_number();
  for (std::size_t k = 20; k < 32; ++k) {
    const Value::List& corners = dragged.at("images").as_list()[k].at("footprint").as_list();
    ASSERT_EQ(corners.size(), 4u);
    double twice = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Value::List &p = corners[i].as_list(), &q = corners[(i + 1) % 4].as_list();
      twice += p[0].as_number() * q[1].as_number() - q[0].as_number() * p[1].as_number();
    }
    EXPECT_NEAR(twice / 2, 600 * 450 * high * high / (345 * 345), 1e-6 * twice);
  }
  page_->send_text(R"({"type": "gesture", "id": "g", "label": "flights", "patch": )" + patch +
                   ", \"base\": " + std::to_string(revision_) + "}");
  const Value settled = told_flight();
  EXPECT_TRUE(settled.at("edit").is_null());
  EXPECT_EQ(settled.at("images"), dragged.at("images"));
  const Value world = page_->until_type("world");
  const Value::List &flown = world.at("scan").at("footprints").as_list(),
                    &images = dragged.at("images").as_list();
  ASSERT_EQ(flown.size(), images.size());
  for (std::size_t k = 0; k < flown.size(); ++k) EXPECT_EQ(flown[k], images[k].at("footprint"));
}

// Of 2 GiB, almost all of it a hole: refused at once, with the largest that there may be.
TEST_F(StudioLooks, AMapThatIsTooLargeIsRefused) {
  write_file_atomically(folder_ / "large.bt", "# Octomap OcTree binary file\n");
  fs::resize_file(folder_ / "large.bt", std::uintmax_t{2} << 30);
  write_file_atomically(folder_ / "prior.ply", "ply\n");
  script_ = "prior.lua";
  write_file_atomically(folder_ / script_, R"(
return require("mission.scan").of_prior {
  name = "p", start = {0, 0, 20}, region = { lower = {-5, -5, 0}, upper = {5, 5, 6} },
  prior = { map = "large.bt", mesh = "prior.ply" },
}
)");
  address_ = std::make_unique<StudioAddress>(serve());
  page_ = std::make_unique<PageClient>(*address_, "a");
  const Value said = page_->until([](const Value& m) {
    return m.at("type") == Value("script_error") || m.at("type") == Value("answer");
  });
  EXPECT_THAT(said.at("message").as_text(),
              HasSubstr("the map has 2147483648 bytes, and the largest that can be read has "
                        "1073741824"));
}

TEST_F(StudioLooks, AFilmHasNoMap) {
  use("filming/castle_flyover.lua");
  address_ = std::make_unique<StudioAddress>(serve());
  page_ = std::make_unique<PageClient>(*address_, "a");
  EXPECT_THAT(why(R"("type": "left_out")"), HasSubstr("'film' has no map of a first flight"));
}

}  // namespace
}  // namespace lapwing
