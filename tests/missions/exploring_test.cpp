// Explorations end to end.
#include <gmock/gmock.h>

#include <array>
#include <map>
#include <set>
#include <sstream>

#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

// A yard with two houses, 40 m wide.
constexpr const char* kYard = R"(v -20 -20 0.1
v 20 -20 0.1
v 20 20 0.1
v -20 20 0.1
f 1 2 3 4
v 6.1 -8.1 0.1
v 14.1 -8.1 0.1
v 14.1 2.1 0.1
v 6.1 2.1 0.1
v 6.1 -8.1 7.1
v 14.1 -8.1 7.1
v 14.1 2.1 7.1
v 6.1 2.1 7.1
f 9 10 11 12
f 5 6 10 9
f 6 7 11 10
f 7 8 12 11
f 8 5 9 12
)";

// A closed room of 5 x 8 x 9 m; 8 m high where y is up.
constexpr const char* kRoom = R"(v 0.1 0.1 0.1
v 5.1 0.1 0.1
v 5.1 8.1 0.1
v 0.1 8.1 0.1
v 0.1 0.1 9.1
v 5.1 0.1 9.1
v 5.1 8.1 9.1
v 0.1 8.1 9.1
f 1 2 3 4
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

class Exploring : public Filming {
 protected:
  // The yard, with few images of few pixels.
  std::string few(const std::string& more) {
    const fs::path mesh = folder_ / "yard.obj";
    write_file_atomically(mesh, kYard);
    return "--config explore/small --set start=[0,0,4] --set input='" + mesh.string() + "' " + more;
  }
  Flown explore(const std::string& more, const char* out) {
    return fly("../explore/own_mesh.lua", few(more), out);
  }
  // What is said of bad input; empty where it is taken.
  std::string refusal(const std::string& more) {
    const std::string errors = (folder_ / "errors.txt").string();
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" +
                             (kExamples / "../explore/own_mesh.lua").string() +
                             "' --quiet --out '" + (folder_ / "refused").string() + "' " + more +
                             " 2> '" + errors + "'";
    return WEXITSTATUS(std::system(line.c_str())) == 2 ? read_file(errors) : "";
  }
};

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
  const std::string report = read_file(one.folder / "report.html");
  for (const char* section :
       {"Growth of the map", "Candidates at the last step", "relative to the oracle"})
    EXPECT_NE(report.find(section), std::string::npos) << section;
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
      {"--set utility=frontiers", "frontier"}};
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
  EXPECT_NE(with_model(damaged).find("broken.model' is no model"), std::string::npos)
      << with_model(damaged);
  damaged = shipped;  // another header
  damaged.replace(damaged.find("\"mean\":140"), 10, "\"mean\":240");
  EXPECT_NE(with_model(damaged).find("checksum"), std::string::npos) << with_model(damaged);
  EXPECT_NE(with_model(shipped.substr(0, 5000)).find("broken.model' is no model"),
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
  for (const auto& [ends, expected] : {std::pair{"--set budget=0.1", "the next view lies beyond"},
                                       {"--set wall_clock_guard=1e-9", "stopped by the wall"},
                                       {"--quiet --set budget=0.1", "the next view lies beyond"}}) {
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

// What was there is kept, what is missing is made again, and the tables are the same.
TEST_F(Exploring, AnEvaluationGoesOnWhereItWasStopped) {
  few("");  // writes the yard
  const auto evaluate = [&](const std::string& more, const fs::path& out) {
    const std::string line = std::string(LAPWING_BUILD_DIR) +
                             "/bin/lapwing evaluate explore --world '" +
                             (folder_ / "yard.obj").string() +
                             "' --utility frontier --utility oracle --utility learned --episodes 2 "
                             "--steps 3 "
                             "--quiet -o '" +
                             out.string() + "' " + more;
    return WEXITSTATUS(std::system(line.c_str()));
  };
  const fs::path whole = folder_ / "whole", broken = folder_ / "broken";
  ASSERT_EQ(evaluate("--threads 2", whole), 0);
  ASSERT_EQ(evaluate("--threads 1", broken), 0);
  int removed = 0;
  for (const auto& entry : fs::directory_iterator(broken / "episodes"))
    if (++removed % 2 == 0) fs::remove(entry.path());
  EXPECT_EQ(removed, 6);
  fs::remove(broken / "table.csv");
  const std::string errors = (folder_ / "errors.txt").string();
  const auto refused = [&](const std::string& more, const fs::path& out, const char* expected) {
    EXPECT_EQ(evaluate(more + " 2> '" + errors + "'", out), 2) << more;
    EXPECT_NE(read_file(errors).find(expected), std::string::npos) << more << read_file(errors);
  };
  // Half a file is found, and said how to be rid of.
  const fs::path half = fs::directory_iterator(broken / "episodes")->path();
  const std::string episode_text = read_file(half);
  write_file_atomically(half, episode_text.substr(0, episode_text.size() / 2));
  refused("--resume", broken, "delete it");
  write_file_atomically(half, episode_text);
  ASSERT_EQ(evaluate("--resume", broken), 0);
  for (const char* file : {"table.csv", "curves.csv", "report.html"})
    EXPECT_EQ(read_file(whole / file), read_file(broken / file)) << file;
  EXPECT_NE(read_file(whole / "table.csv").find("yard.obj,oracle,2"), std::string::npos);
  // The table's figures anew from the episodes themselves.
  std::map<std::string, std::array<double, 2>> efficiency;  // by utility: of both episodes
  for (const auto& entry : fs::directory_iterator(whole / "episodes")) {
    const Value episode = from_json(read_file(entry.path()), "episode");
    double& sum = efficiency[episode.at("utility").as_text()]
                            [static_cast<std::size_t>(episode.at("episode").as_integer() - 1)];
    const Value::List& observed = episode.at("observed").as_list();
    for (const Value& seen : observed) sum += seen.as_number();
    // It stays as it is after an early end.
    for (std::size_t k = observed.size(); k < 3; ++k) sum += observed.back().as_number();
  }
  ASSERT_EQ(efficiency.size(), 3u);
  const auto [oracle_1, oracle_2] = efficiency["oracle"];
  const auto [learned_1, learned_2] = efficiency["learned"];
  std::istringstream table(read_file(whole / "table.csv"));
  int rows = 0;
  for (std::string line, cell; std::getline(table, line);) {
    std::vector<std::string> cells;
    for (std::istringstream row(line); std::getline(row, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 14u) << line;
    if (cells[0] != "yard.obj") continue;
    EXPECT_EQ(cells[13], "2");
    ++rows;
    const auto [first, second] = efficiency.at(cells[1]);
    EXPECT_NEAR(std::stod(cells[3]), (first + second) / 2, 1e-3 * first);
    // Mean, deviation and interval of two: 12.706 (Student's t) deviations over root 2.
    const auto expect_mean = [&](int at, double a, double b) {
      EXPECT_NEAR(std::stod(cells[at]), (a + b) / 2, 1e-4) << line;
      const double deviation = std::abs(a - b) / std::sqrt(2.0);
      return 12.706 * deviation / std::sqrt(2.0);
    };
    EXPECT_NEAR(std::stod(cells[7]), expect_mean(5, first / oracle_1, second / oracle_2), 1e-4);
    EXPECT_NEAR(std::stod(cells[9]),
                expect_mean(8, (learned_1 - first) / oracle_1, (learned_2 - second) / oracle_2),
                1e-4);
  }
  EXPECT_EQ(rows, 3);
  EXPECT_NE(read_file(whole / "seconds.csv").find("yard.obj,oracle,2,0."), std::string::npos);
  refused("--utility learned", folder_ / "twice", "--utility learned: is named twice");
  refused("--resume --seed 5", broken, "seed is 1 there, 5 here");
  refused("--resume --moves clear=3", broken, "\"clear\":6.0} there, {\"step\":2.5,");
  refused("", broken, "go on with --resume");
  // Another mesh of the name, and a folder that is none of ours.
  const std::string mesh = read_file(folder_ / "yard.obj");
  write_file_atomically(folder_ / "yard.obj", mesh + "# moved\n");
  refused("--resume", broken, "the file of yard.obj is another one");
  write_file_atomically(folder_ / "yard.obj", mesh);
  fs::create_directories(folder_ / "elsewhere");
  write_file_atomically(folder_ / "elsewhere" / "yard.obj", mesh);
  refused("--world '" + (folder_ / "elsewhere/yard.obj").string() + "'", folder_ / "twice",
          "would both be called 'yard.obj'");
  fs::remove(broken / "settings.json");
  for (const char* more : {"", "--resume"}) refused(more, broken, "choose another folder");
  write_file_atomically(broken / "settings.json", "{\"colour\": 3}");
  refused("", broken, "choose another folder");
  EXPECT_TRUE(fs::exists(half));
  for (const char* noise : {"--sigma nan", "--sigma -1", "--sigma inf", "--dropped -3",
                            "--dropped 1.5", "--dropped nan", "--stereo nan", "--stereo -1"})
    refused(noise, folder_ / "noise", "expected a number from 0 to");
  EXPECT_EQ(evaluate("--moves clear=0.5", folder_ / "small"), 2);  // the body does not fit
  EXPECT_EQ(evaluate("--moves leap=3", folder_ / "unknown"), 2);
}

// Inside a closed box without a floor laid under it, and only what is a place or an axis.
TEST_F(Exploring, AnEvaluationTakesTheSpaceWithinAMesh) {
  const fs::path room = folder_ / "room.obj";
  write_file_atomically(room, kRoom);
  const auto evaluate = [&](const std::string& world, const std::string& more) {
    const std::string line =
        std::string(LAPWING_BUILD_DIR) + "/bin/lapwing evaluate explore --world '" + world +
        "' --utility frontier --episodes 1 --steps 2 --quiet --moves step=0.7 --moves body=0.6 "
        "--moves clear=2 -o '" +
        (folder_ / "within").string() + "' 2> /dev/null " + more;
    return WEXITSTATUS(std::system(line.c_str()));
  };
  const auto surface = [&](const std::string& name) {
    const fs::path path = folder_ / "within/episodes" / (name + "_frontier_1.json");
    return from_json(read_file(path), "episode").at("surface").as_number();
  };
  // Voxels of 0.4 m: six sides from within, none from without, none of a floor beyond them.
  ASSERT_EQ(evaluate(room.string() + "@2.5,-4,4.5", "--up y"), 0);
  const double within = surface("room.obj_2.5_-4_4.5");
  const double sides = 2 * (5 * 9 + 5 * 8 + 9 * 8) / 0.16;
  EXPECT_GT(within, 0.8 * sides);
  EXPECT_LT(within, 1.2 * sides);
  EXPECT_NE(read_file(folder_ / "within/table.csv").find("\nroom.obj@2.5 -4 4.5,frontier,1,"),
            std::string::npos);
  fs::remove_all(folder_ / "within");
  ASSERT_EQ(evaluate(room.string(), ""), 0);
  EXPECT_GT(surface("room.obj"), 2 * within);
  EXPECT_EQ(evaluate(room.string() + "@1,2", ""), 2);
  EXPECT_EQ(evaluate(room.string() + "@1,2,x", ""), 2);
  EXPECT_EQ(evaluate("office@1,2,3", ""), 2);
  EXPECT_EQ(evaluate(room.string(), "--up w"), 2);
  EXPECT_EQ(evaluate("office", "--up y"), 2);
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
              said = explore("--set up=y --set unit=0.01 --set input='" + mesh.string() + "'",
                             "said");
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

// Samples are neither written over nor taken for others.
TEST_F(Exploring, SamplesAreKept) {
  few("");  // writes the yard
  const fs::path folder = folder_ / "samples", file = folder / "yard.obj_1.samples";
  const std::string errors = (folder_ / "errors.txt").string();
  const auto made = [&](const std::string& more) {
    const std::string line = std::string(LAPWING_BUILD_DIR) +
                             "/bin/lapwing train dataset --world '" +
                             (folder_ / "yard.obj").string() + "' --steps 2 --quiet -o '" +
                             folder.string() + "' " + more + " 2> '" + errors + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  ASSERT_EQ(made("--episodes 1"), 0) << read_file(errors);
  const std::string first = read_file(file);
  EXPECT_EQ(made("--episodes 1"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("--resume keeps it"));
  for (const auto& [more, expected] : std::vector<std::pair<const char*, const char*>>{
           {"--seed 2", "seed is 1 there, 2 here"},
           {"--explorer frontier", "explorer is \"oracle\" there"},
           {"--moves clear=5", "moves is"},
           {"--set grid.levels=2", "grid is"}}) {
    EXPECT_EQ(made(std::string("--resume --episodes 2 ") + more), 2) << more;
    EXPECT_THAT(read_file(errors), testing::HasSubstr(expected)) << more;
  }
  EXPECT_FALSE(fs::exists(folder / "yard.obj_2.samples"));
  ASSERT_EQ(made("--resume --episodes 2"), 0) << read_file(errors);
  EXPECT_TRUE(fs::exists(folder / "yard.obj_2.samples"));
  EXPECT_EQ(read_file(file), first);
  // Another episode's file in the place of one, and what is wrong is known before any is flown.
  fs::copy_file(file, folder / "yard.obj_3.samples");
  EXPECT_EQ(made("--resume --episodes 3"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("it is episode 1"));
  fs::remove(folder / "yard.obj_3.samples");
  EXPECT_EQ(made("--resume --episodes 3 --world nowhere"), 2);
  EXPECT_FALSE(fs::exists(folder / "yard.obj_3.samples"));
}

}  // namespace
}  // namespace lapwing
