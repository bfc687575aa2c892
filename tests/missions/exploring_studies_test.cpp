// SPDX-License-Identifier: Apache-2.0
// Studies of explorations: evaluations, their folders, what they refuse.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <tuple>

#include "tests/missions/exploring_fixture.h"

namespace lapwing {
namespace {

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
    ASSERT_EQ(cells.size(), 17u) << line;
    if (cells[0] != "yard.obj") continue;
    EXPECT_EQ(cells[3], "2");
    ++rows;
    const auto [first, second] = efficiency.at(cells[1]);
    EXPECT_NEAR(std::stod(cells[6]), (first + second) / 2, 1e-3 * first);
    // Mean, deviation and interval of two: 12.706 (Student's t) deviations over root 2.
    const auto expect_mean = [&](int at, double a, double b) {
      EXPECT_NEAR(std::stod(cells[at]), (a + b) / 2, 1e-4) << line;
      const double deviation = std::abs(a - b) / std::sqrt(2.0);
      return 12.706 * deviation / std::sqrt(2.0);
    };
    EXPECT_NEAR(std::stod(cells[10]), expect_mean(8, first / oracle_1, second / oracle_2), 1e-4);
    EXPECT_NEAR(std::stod(cells[12]),
                expect_mean(11, (learned_1 - first) / oracle_1, (learned_2 - second) / oracle_2),
                1e-4);
  }
  EXPECT_EQ(rows, 3);
  EXPECT_NE(read_file(whole / "seconds.csv").find("yard.obj,oracle,2,0."), std::string::npos);
  // Another utility's episode in the place of one.
  const fs::path theirs = broken / "episodes" / "yard.obj_frontier_1.json";
  const std::string own_text = read_file(theirs);
  fs::copy_file(broken / "episodes" / "yard.obj_oracle_1.json", theirs,
                fs::copy_options::overwrite_existing);
  refused("--resume", broken, "is oracle's episode 1: delete it");
  write_file_atomically(theirs, own_text);
  refused("--utility learned", folder_ / "twice", "--utility learned: is named twice");
  refused("--resume --seed 5", broken, "seed is 1 there, 5 here");
  refused("--resume --moves clear=3", broken, "\"clear\":6.0} there, {\"step\":2.5,");
  refused("", broken, "continue it with --resume");
  // Another mesh of the name, and a folder that is none of ours.
  const std::string mesh = read_file(folder_ / "yard.obj");
  write_file_atomically(folder_ / "yard.obj", mesh + "# moved\n");
  refused("--resume", broken, "the file of yard.obj is another one");
  write_file_atomically(folder_ / "yard.obj", mesh);
  fs::create_directories(folder_ / "elsewhere");
  write_file_atomically(folder_ / "elsewhere" / "yard.obj", mesh);
  refused("--world '" + (folder_ / "elsewhere/yard.obj").string() + "'", folder_ / "twice",
          "would both have the name 'yard.obj'");
  // Names that make the same names of files.
  const auto blank = [&](const char* name) {
    fs::copy_file(folder_ / "yard.obj", folder_ / name);
    return "--world '" + (folder_ / name).string() + "'";
  };
  ASSERT_EQ(evaluate(blank("a b.obj"), folder_ / "alike"), 0);
  refused("--resume " + blank("a_b.obj"), folder_ / "alike", "is of the world 'a b.obj', not");
  fs::remove(broken / "settings.json");
  for (const char* more : {"", "--resume"}) refused(more, broken, "choose another folder");
  write_file_atomically(broken / "settings.json", "{\"colour\": 3}");
  refused("", broken, "choose another folder");
  EXPECT_TRUE(fs::exists(half));
  write_file_atomically(folder_ / "mine/report.html", "mine");
  refused("", folder_ / "mine", "report.html' is not of an evaluation");
  EXPECT_EQ(read_file(folder_ / "mine/report.html"), "mine");
  for (const char* seeds : {"18446744073709551615", "18446744073709551614-18446744073709551615"})
    refused(std::string("--world street:") + seeds, folder_ / "seeds",
            "expected seeds up to 9007199254740991");
  for (const char* noise :
       {"--sigma nan", "--sigma -1", "--sigma inf", "--dropped -3", "--dropped 1.5",
        "--dropped nan", "--smooth-to -1", "--smooth-to nan", "--stereo nan", "--stereo -1"})
    refused(noise, folder_ / "noise", "expected a number from 0 to");
  refused("--smooth-to 0.2 --dropped 0.4", folder_ / "noise", "no noise to smooth");
  refused("--smooth-to 0.5 --sigma 0.1", folder_ / "noise", "there is nothing to smooth");
  refused("--smooth-to 0.1 --sigma 1 --dropped 0.4", folder_ / "noise", "reaches 0.117 m");
  EXPECT_EQ(evaluate("--moves clear=0.5", folder_ / "small"), 2);  // the body does not fit
  EXPECT_EQ(evaluate("--moves leap=3", folder_ / "unknown"), 2);
}

// Noise against none, start by start (table 5.4), in two worlds that differ in nothing but names.
TEST_F(Exploring, AnEvaluationIsComparedWithAnother) {
  few("");  // writes the yard
  fs::copy_file(folder_ / "yard.obj", folder_ / "field.obj", fs::copy_options::overwrite_existing);
  const std::string errors = (folder_ / "errors.txt").string();
  const auto evaluate = [&](const std::string& more, const char* out,
                            const std::string& size = "--episodes 2 --steps 3") {
    const std::string line =
        std::string(LAPWING_BUILD_DIR) + "/bin/lapwing evaluate explore --world '" +
        (folder_ / "yard.obj").string() + "' --world '" + (folder_ / "field.obj").string() +
        "' --utility frontier --quiet -o '" + (folder_ / out).string() + "' " + size + " " + more +
        " 2> '" + errors + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  ASSERT_EQ(evaluate("", "clear"), 0) << read_file(errors);
  const std::string against = " --against '" + (folder_ / "clear").string() + "'";
  ASSERT_EQ(evaluate("--dropped 0.9 --sigma 2" + against, "noisy"), 0) << read_file(errors);
  const auto efficiency = [&](const char* folder, const char* episode) {
    const fs::path path = folder_ / folder / "episodes" / episode;
    const Value read = from_json(read_file(path), "episode");
    const Value::List& observed = read.at("observed").as_list();
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      sum += observed[std::min(k, observed.size() - 1)].as_number();
    return sum;
  };
  const char* names[] = {"yard.obj_frontier_1.json", "yard.obj_frontier_2.json"};
  double ratios[2];
  for (int k = 0; k < 2; ++k)
    ratios[k] = efficiency("noisy", names[k]) / efficiency("clear", names[k]);
  EXPECT_LT(ratios[0] + ratios[1], 1.9) << "noise that costs nothing shows nothing";
  // Smoothed depth leads elsewhere, and is another evaluation.
  const std::string ten = "--utility proximity_count --episodes 1 --steps 10";
  ASSERT_EQ(evaluate("--sigma 2", "raw", ten), 0) << read_file(errors);
  ASSERT_EQ(evaluate("--sigma 2 --smooth-to 0.5", "smooth", ten), 0) << read_file(errors);
  const auto observed = [&](const char* folder) {
    const fs::path path = folder_ / folder / "episodes/yard.obj_proximity_count_1.json";
    return to_json(from_json(read_file(path), "episode").at("observed"));
  };
  EXPECT_NE(observed("smooth"), observed("raw"));
  EXPECT_EQ(evaluate("--resume --sigma 2", "smooth", ten), 2);
  EXPECT_NE(read_file(errors).find("smooth_to"), std::string::npos) << read_file(errors);
  std::map<std::string, std::vector<std::string>> rows;  // by world
  std::istringstream table(read_file(folder_ / "noisy/table.csv"));
  for (std::string line, cell; std::getline(table, line);) {
    std::vector<std::string> cells;
    for (std::istringstream row(line); std::getline(row, cell, ',');) cells.push_back(cell);
    rows[cells.at(0)] = cells;
  }
  const auto number = [&](const char* world, const char* column) {
    const auto& head = rows.at("world");
    const auto at = std::find(head.begin(), head.end(), column) - head.begin();
    return std::stod(rows.at(world).at(static_cast<std::size_t>(at)));
  };
  const double spread = std::abs(ratios[0] - ratios[1]);
  for (const char* world : {"yard.obj", "field.obj"}) {
    EXPECT_NEAR(number(world, "against"), (ratios[0] + ratios[1]) / 2, 1e-4);
    EXPECT_NEAR(number(world, "against_deviation"), spread / std::sqrt(2.0), 1e-4);
    EXPECT_NEAR(number(world, "against_interval"), 12.706 * spread / 2, 1e-3);
  }
  // Both worlds together: the same two values twice.
  EXPECT_EQ(number("all", "episodes"), 4);
  EXPECT_NEAR(number("all", "efficiency"), number("yard.obj", "efficiency"), 1e-3);
  EXPECT_NEAR(number("all", "against"), number("yard.obj", "against"), 1e-4);
  // Of two worlds with two starts each, whatever lies between the worlds: two degrees of freedom.
  EXPECT_NEAR(number("all", "against_interval"), 4.303 * spread / std::sqrt(8.0), 1e-3);
  const char* usual = "--episodes 2 --steps 3";
  for (const auto& [size, more, expected] :
       std::vector<std::tuple<const char*, std::string, const char*>>{
           {usual, "--seed 2" + against, "its starts differ: seed is 1 there, 2 here"},
           {"--episodes 2 --steps 4", against, "steps is 3 there, 4 here"},
           {"--episodes 3 --steps 3", against, "frontier's episode 3 in yard.obj is not there"},
           {usual, "--utility learned" + against, "learned's episode 1 in yard.obj is not there"},
           {usual, "--against '" + folder_.string() + "'", "no evaluation is there"}}) {
    EXPECT_EQ(evaluate(more, "other", size), 2) << size << more;
    EXPECT_THAT(read_file(errors), testing::HasSubstr(expected)) << size << more;
    EXPECT_FALSE(fs::exists(folder_ / "other")) << more;
  }
  EXPECT_EQ(evaluate("--resume" + against, "clear"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("is the folder of this evaluation"));
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

// What a script requires is part of the world that it makes, and what fails leaves nothing behind.
TEST_F(Exploring, AnEvaluationKnowsWhatItsWorldsAreMadeBy) {
  const auto write_modules = [&](double height) {
    write_file_atomically(folder_ / "sizes.lua",
                          "return { height = " + std::to_string(height) + " }");
  };
  write_modules(3);
  write_file_atomically(folder_ / "two, three.lua", R"(local sizes = require "sizes"
return function(options)
  local scene = lapwing.scene { name = "hut", seed = options.seed }
  scene:box({-12, -12, -1}, {16, 15, 0})
  scene:box({0, 0, 0}, {4, 3, sizes.height})
  scene:region({-12, -12, 0}, {16, 15, 10})
  return scene
end)");
  const std::string errors = (folder_ / "errors.txt").string();
  const fs::path out = folder_ / "made";
  const auto evaluate = [&](const std::string& more) {
    const std::string line =
        std::string(LAPWING_BUILD_DIR) + "/bin/lapwing evaluate explore --world '" +
        (folder_ / "two, three.lua").string() +
        "' --utility frontier --episodes 1 --steps 12 -o '" + out.string() + "' " + more + " > '" +
        (folder_ / "answer.txt").string() + "' 2> '" + errors + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  EXPECT_EQ(evaluate("--world nowhere"), 2);
  EXPECT_FALSE(fs::exists(out));
  const std::string script = read_file(folder_ / "two, three.lua");
  write_file_atomically(folder_ / "two, three.lua", "return function() error('no bricks') end");
  EXPECT_EQ(evaluate(""), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("no bricks"));
  EXPECT_FALSE(fs::exists(out));
  write_file_atomically(folder_ / "two, three.lua", script);
  ASSERT_EQ(evaluate("--json"), 0) << read_file(errors);
  const Value answer = from_json(read_file(folder_ / "answer.txt"), "answer");
  const Value& row = answer.at("rows").as_list().at(0);
  EXPECT_EQ(row.at("world").as_text(), "two, three.lua 1");
  EXPECT_GT(row.at("efficiency").as_number(), 0);
  EXPECT_TRUE(row.at("relative").is_null()) << "no oracle flew";
  EXPECT_THAT(read_file(out / "table.csv"),
              testing::HasSubstr("\n\"two, three.lua 1\",frontier,1,"));
  ASSERT_EQ(evaluate("--resume --quiet"), 0) << read_file(errors);
  EXPECT_EQ(read_file(folder_ / "answer.txt"), "");
  EXPECT_EQ(evaluate("--resume --mapping range=10"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("mapping is"));
  write_modules(4);
  EXPECT_EQ(evaluate("--resume"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("the file of two, three.lua 1 is another one"));
  EXPECT_EQ(evaluate("--moves step=0"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("--moves step=0: step: "));
  fs::remove_all(out);
  EXPECT_EQ(evaluate("--moves clear=1e12"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("more than 2^24 voxels"));
}

}  // namespace
}  // namespace lapwing
