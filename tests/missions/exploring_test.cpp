// SPDX-License-Identifier: Apache-2.0
// Explorations end to end.
#include <set>
#include <sstream>

#include "tests/missions/exploring_fixture.h"

namespace lapwing {
namespace {

TEST_F(Exploring, AMeshIsExploredTheSameByAnyNumberOfThreads) {
  const Flown one = explore("--threads 1", "one"), two = explore("--threads 2", "two");
  EXPECT_EQ(one.status, 0);
  EXPECT_EQ(one.result.at("kind").as_text(), "explore");
  const Value& figures = one.result.at("exploration");
  EXPECT_GT(figures.at("efficiency").as_number(), figures.at("observed_surface").as_number());
  EXPECT_GT(figures.at("observed_surface").as_number(), 50);
  EXPECT_EQ(figures.at("images").as_integer(), 8);
  EXPECT_EQ(read_file(one.folder / "plan.json"), read_file(two.folder / "plan.json"));
  EXPECT_EQ(read_file(one.folder / "map.ot"), read_file(two.folder / "map.ot"));
  for (const char* file : {"episode.json", "episode_growth.bin", "episode_sights.bin"})
    EXPECT_EQ(read_file(one.folder / file), read_file(two.folder / file)) << file;
  const std::string report = read_file(one.folder / "report.html");
  for (const char* section : {"Growth of the map", "Candidates at the last step",
                              "relative to the oracle", "Certainty, 64 points along an edge"})
    EXPECT_NE(report.find(section), std::string::npos) << section;
}

// The plan is a motion that a simulated vehicle follows, and its time is that of the exploration.
TEST_F(Exploring, AnExplorationIsFlown) {
  for (const char* choice : {"images", "seconds"}) {
    const Flown flown = explore(std::string("--set steps=6 --set efficiency=") + choice, choice);
    ASSERT_EQ(flown.status, 0) << choice;
    double worst = -1;
    for (const Value& check : flown.result.at("certificate").at("checks").as_list())
      if (check.at("name").as_text() == "closed_loop") worst = check.at("worst").as_number();
    EXPECT_GE(worst, 0) << "nothing was flown";
    EXPECT_LT(worst, 0.05) << choice;
    const Value plan = from_json(read_file(flown.folder / "plan.json"), "plan");
    EXPECT_EQ(plan.at("motion").at("model").as_text(), "force");
  }
  const Flown slow = explore("--set steps=6 --set moves.acceleration=0.3", "slow");
  EXPECT_EQ(slow.status, 0);
  EXPECT_NE(refusal(few("--set moves.acceleration=0")).find("moves.acceleration"),
            std::string::npos);
  EXPECT_NE(refusal(few("--set efficiency=metres")).find("efficiency"), std::string::npos);
}

TEST_F(Exploring, UtilitiesAreSwappedByConfiguration) {
  const double oracle = explore("--set utility=oracle", "oracle")
                            .result.at("exploration")
                            .at("relative_efficiency")
                            .as_number();
  EXPECT_DOUBLE_EQ(oracle, 1);
  for (const char* utility : {"average_entropy", "proximity_count"}) {
    const Flown flown = explore(std::string("--set utility=") + utility, utility);
    EXPECT_EQ(flown.result.at("solver").at("name").as_text(), utility);
  }
}

TEST_F(Exploring, BadInputIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"--set start=[10,-3,3]", "obstacle"},
      {"--set start=[500,500,50]", "far outside the scene: expected within (-50, "},
      {"--set moves.step=4", "no neighbour"},
      {"--set utility=learned --set camera.width=160 --set camera.height=120 --set resolution=0.2",
       "resolution is 0.2 m, the model's 0.4 m"},
      {"--set lower=[0,0,0]", "belong together"},
      {"--set lower=[9,9,9] --set upper=[9,19,19]", "lower must be below upper"},
      {"--set lower=[9,9,1] --set upper=[19,19,9]", "the start lies outside the bounds"},
      {"--set margin=0.6", "half of moves.body"},
      {"--set map.resolution=0.2", "resolution"},
      {"--set utility=frontiers", "frontier"},
      {"--set utility.pixel_step=64 --set camera.height=24", "80 x 24: expected at most 47"}};
  for (const auto& [more, expected] : cases)
    EXPECT_NE(refusal(few(more)).find(expected), std::string::npos)
        << more << ": " << refusal(few(more));
  EXPECT_NE(refusal("").find("--set input=PATH"), std::string::npos);
  EXPECT_NE(refusal(few("--set lookahead=9")).find("lookahead"), std::string::npos);
}

TEST_F(Exploring, DamagedModelsAndEmptyScenesAreNamed) {
  const fs::path model = folder_ / "broken.model", empty = folder_ / "empty.obj";
  const std::string shipped =
      read_file(fs::path(LAPWING_BUILD_DIR) / "lib/plugins/utilities/learned.model");
  const auto with_model = [&](const std::string& bytes) {
    write_file_atomically(model, bytes);
    return refusal(few("--set 'utility={type: learned, model: " + model.string() +
                       "}' --set camera.width=160 --set camera.height=120"));
  };
  std::string damaged = shipped;
  damaged[damaged.size() / 2] ^= 0x10;
  EXPECT_NE(with_model(damaged).find("broken.model' is not a model"), std::string::npos)
      << with_model(damaged);
  damaged = shipped;  // another header
  damaged.replace(damaged.find("\"width\":32"), 10, "\"width\":64");
  EXPECT_NE(with_model(damaged).find("checksum"), std::string::npos) << with_model(damaged);
  EXPECT_NE(with_model(shipped.substr(0, 5000)).find("broken.model' is not a model"),
            std::string::npos);
  fs::remove(model);
  EXPECT_NE(refusal(few("--set 'utility={type: learned, model: " + model.string() + "}'"))
                .find("broken.model"),
            std::string::npos);
  write_file_atomically(empty, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  const std::string of_empty =
      refusal("--config explore/small --set input='" + empty.string() + "'");
  EXPECT_NE(of_empty.find("empty.obj"), std::string::npos) << of_empty;
}

// A budget that is too short for the first image: no plan, and it says why.
TEST_F(Exploring, WithoutAnImageThereIsNoPlan) {
  const std::string said = (folder_ / "said.txt").string();
  for (const auto& [ends, expected] :
       {std::pair{"--set budget=0.1", "the next view is beyond"},
        {"--set wall_clock_guard=1e-9", "stopped by wall_clock_guard"},
        {"--quiet --set budget=0.1", "the next view is beyond"}}) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" +
                             (kExamples / "../explore/own_mesh.lua").string() + "' --out '" +
                             (folder_ / "short").string() + "' " + few(ends) + " > '" + said +
                             "' 2>&1";
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1) << ends;
    EXPECT_NE(read_file(said).find(std::string("no image was taken: ") + expected),
              std::string::npos)
        << ends << read_file(said);
  }
}

TEST_F(Exploring, NoiseIsSmoothedWhereThatIsAskedFor) {
  const auto map = [&](const std::string& more, const char* out) {
    const Flown flown =
        explore("--set compare=false --set steps=2 --set camera.sigma=1" + more, out);
    EXPECT_TRUE(fs::exists(flown.folder / "map.ot")) << out;
    return read_file(flown.folder / "map.ot");
  };
  const std::string noisy = map("", "noisy");
  EXPECT_EQ(map(" --set camera.smooth_to=0", "zero"), noisy);
  const std::string smooth = map(" --set camera.smooth_to=0.2", "smooth");
  EXPECT_NE(smooth, noisy);
  EXPECT_NE(map(" --set camera.smooth_to=0.4", "less"), smooth);
  EXPECT_NE(refusal(few("--set camera.smooth_to=0.2")).find("there is no noise to smooth"),
            std::string::npos);
  EXPECT_NE(refusal(few("--set camera.sigma=1 --set camera.smooth_to=-1")).find("smooth_to"),
            std::string::npos);
  EXPECT_NE(refusal(few("--set camera.sigma=0.1 --set camera.smooth_to=0.5"))
                .find("there is nothing to smooth; expected less than sigma, which is 0.1 m"),
            std::string::npos);
  EXPECT_NE(refusal(few("--set camera.sigma=1 --set camera.smooth_to=0.001"))
                .find("11 x 11 pixels, reaches 0.09"),
            std::string::npos);
}

// What noise puts into the map is no surface that was found.
TEST_F(Exploring, NoiseFindsNoSurface) {
  const auto observed = [&](const char* more, const char* out) {
    return explore(std::string("--set compare=false --set steps=1 ") + more, out)
        .result.at("exploration")
        .at("observed_surface")
        .as_number();
  };
  const double clear = observed("", "clear");  // one image, of the same view
  EXPECT_GT(clear, 0);
  EXPECT_DOUBLE_EQ(observed("--set camera.sigma=20", "noisy"), clear);
  EXPECT_DOUBLE_EQ(observed("--set camera.dropped=0.4", "dropped"), clear);
}

// The map at four moments, however early it ends; the oracle is compared without the guard.
TEST_F(Exploring, AnEarlyEndIsShownInFourPicturesToo) {
  const Flown flown = explore("--set steps=200 --set budget=30 --set compare=false", "early");
  const auto images = flown.result.at("exploration").at("images").as_integer();
  ASSERT_LT(images, 200);
  ASSERT_GT(images, 8);
  const std::string report = read_file(flown.folder / "report.html");
  std::set<std::string> pictures;
  for (std::size_t at = 0; (at = report.find("after ", at)) != std::string::npos; ++at)
    if (const std::size_t end = report.find(" images", at); end < at + 12)
      pictures.insert(report.substr(at, end - at));
  EXPECT_EQ(pictures.size(), 4u);
  EXPECT_NE(report.find("after " + std::to_string(images) + " images"), std::string::npos);
}

// A mesh in centimetres, y up, is the same yard once that is said.
TEST_F(Exploring, AMeshMaySayLessThanItsUser) {
  const fs::path mesh = folder_ / "lying.obj";
  std::istringstream lines(kYard);
  std::string lying;
  for (std::string line; std::getline(lines, line);) {
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3)
      line = "v " + std::to_string(100 * x) + " " + std::to_string(100 * z) + " " +
             std::to_string(-100 * y);
    lying += line + "\n";
  }
  write_file_atomically(mesh, lying);
  const auto figures = [](const Flown& flown) { return flown.result.at("exploration"); };
  const Flown upright = explore("", "upright"),
              said =
                  explore("--set up=y --set unit=0.01 --set input='" + mesh.string() + "'", "said");
  ASSERT_EQ(upright.status, 0);
  ASSERT_EQ(said.status, 0);
  for (const char* figure : {"surface", "observed_surface", "efficiency"})
    EXPECT_NEAR(figures(said).at(figure).as_number(), figures(upright).at(figure).as_number(),
                0.02 * figures(upright).at(figure).as_number())
        << figure;
  EXPECT_NE(refusal(few("--set up=w")).find("expected one of file, x, y, z"), std::string::npos);
  EXPECT_NE(refusal(few("--set unit=0")).find("unit"), std::string::npos);
  EXPECT_NE(refusal(few("--set unit=0.001")).find("0.04 m across"), std::string::npos);
  EXPECT_NE(refusal(few("--set budget=1300")).find("one battery"), std::string::npos);
}

}  // namespace
}  // namespace lapwing
