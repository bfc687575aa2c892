// SPDX-License-Identifier: Apache-2.0
// What authors of plugins and missions meet beside `plugins check`: `new`, the guide, a kind of
// mission of their own, sweeps.
#include <sys/resource.h>

#include <fstream>
#include <regex>

#include "framework/core/json.h"
#include "tests/app/program_fixture.h"
#include "tests/guide.h"
#include "tests/tool.h"

namespace lapwing {
namespace {

class NewFiles : public CommandLine {};

// Of the processor, by all processes started from here that have ended.
double seconds_of_children() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

// Names whose class would be one of the kernel's: all that a plugin's source can see.
TEST_F(NewFiles, NamesOfTheKernelsClassesAreRefused) {
  for (const char* name : {"cost_term", "stage", "rows", "differentiable_cost", "map"})
    refused({"new", "plugin", "cost_term", name},
            {"'" + std::string(name) + "' cannot be a plugin's name", "my_" + std::string(name)});
  const std::string taken =
      "\n" + read_file(fs::path(LAPWING_SOURCE_DIR) / "scripts/templates/taken_names.txt");
  const std::regex declared("(^|\n)(class|struct|enum class|using) ([A-Z][A-Za-z0-9]*)");
  for (const char* room : {"core", "geometry", "picture", "surface", "shape", "trajectory",
                           "vehicle", "map", "path", "problem", "symbolic", "solve", "view",
                           "explore", "verify", "export", "plugin", "flight_log", "items"})
    for (const auto& file :
         fs::directory_iterator(fs::path(LAPWING_SOURCE_DIR) / "framework" / room)) {
      if (file.path().extension() != ".h") continue;
      const std::string text = read_file(file.path());
      for (std::sregex_iterator found(text.begin(), text.end(), declared), end; found != end;
           ++found)
        EXPECT_NE(taken.find("\n" + (*found)[3].str() + "\n"), std::string::npos)
            << (*found)[3] << " of " << file.path()
            << " is missing in scripts/templates/taken_names.txt";
    }
}

// A guide of plugins/README.md, followed to the letter: from nothing to a passed check in a minute,
// and to a flight with it. A Lua snippet is saved under the name in its first line. What it prints.
std::string followed_guide(const fs::path& folder, const std::string& heading, int blocks) {
  std::string script = "set -e\ncd '" + folder.string() +
                       "'\nexport PATH='" LAPWING_BUILD_DIR
                       "/bin':\"$PATH\" lapwing_DIR='" LAPWING_BUILD_DIR "'\n";
  int commands = 0;
  for (const Snippet& snippet : snippets_of(LAPWING_SOURCE_DIR "/plugins/README.md", heading)) {
    if (snippet.language == "sh") {
      script += snippet.text;
      ++commands;
      continue;
    }
    EXPECT_EQ(snippet.text.rfind("-- ", 0), 0u) << snippet.text;
    std::ofstream(folder / snippet.text.substr(3, snippet.text.find('\n') - 3)) << snippet.text;
  }
  EXPECT_EQ(commands, blocks);
  std::ofstream(folder / "guide.sh") << script;
  const int status = std::system(("bash '" + (folder / "guide.sh").string() + "' > '" +
                                  (folder / "log.txt").string() + "' 2>&1")
                                     .c_str());
  const std::string log = read_file(folder / "log.txt");
  EXPECT_EQ(status, 0) << log;
  return log;
}

TEST_F(NewFiles, TheGuideOfControllersHolds) {
  if (tool_on_path({"cmake"}).empty()) GTEST_SKIP() << "there is no cmake";
  if (tool_on_path({"make"}).empty()) GTEST_SKIP() << "there is no make";
  const double began = seconds_of_children();
  const std::string log = followed_guide(folder_, "## Your own controller", 2);
  EXPECT_NE(log.find("100% tests passed, 0 tests failed out of 1"), std::string::npos) << log;
  EXPECT_NE(log.find("hop: certified"), std::string::npos) << log;
  EXPECT_NE(log.find("20 of 20 runs are good"), std::string::npos) << log;
  EXPECT_LT(seconds_of_children() - began, 90);
  EXPECT_NE(read_file(folder_ / "out/hop/plan.json").find("flown by the controller 'spring'"),
            std::string::npos);
}

TEST_F(NewFiles, TheGuideOfPluginsHolds) {
  if (tool_on_path({"cmake"}).empty()) GTEST_SKIP() << "there is no cmake";
  if (tool_on_path({"make"}).empty()) GTEST_SKIP() << "there is no make";
  const double began = seconds_of_children();
  const std::string log = followed_guide(folder_, "## A first cost term", 3);
  EXPECT_NE(log.find("100% tests passed, 0 tests failed out of 1"), std::string::npos) << log;
  EXPECT_NE(log.find("low: certified"), std::string::npos) << log;
  EXPECT_NE(log.find("stays below a height"), std::string::npos) << log;
  EXPECT_LT(seconds_of_children() - began, 60);
  const std::string source = read_file(folder_ / "keep_low/keep_low.cpp");
  EXPECT_LE(std::count(source.begin(), source.end(), '\n'), 60);
  EXPECT_NE(source.find("class KeepLow final"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "keep_low/README.md"));
  refused({"new", "plugin", "cost_term", "keep_low"}, {"exists already"});
  refused({"new", "plugin", "cost_trem", "x"}, {"did you mean 'cost_term'?"});
  refused({"new", "plugin", "cost_term", "KeepLow"}, {"expected snake_case"});
  refused({"new", "plugin", "cost_term", "keyframe"}, {"choose another name"});
  refused({"plugins", "show", "keep_low"}, {"--plugin-path FOLDER"});
  refused({"new", "plugin", "cost_term", "low", "--in", "nowhere/at/all"},
          {"--in: 'nowhere/at/all' is not a folder"});
}

class SlowNewFiles : public NewFiles {};

TEST_F(SlowNewFiles, NewMissionsOfEveryKindAreRight) {
  for (const char* kind : {"film", "race", "light_painting", "map", "scan", "explore", "own"}) {
    const std::string file = std::string("my_") + kind + ".lua";
    Finished finished = run({"new", "mission", kind, file});
    ASSERT_EQ(finished.status, 0) << finished.err;
    // Who has to wait is told before.
    EXPECT_EQ(finished.out.find("Takes minutes") != std::string::npos, kind == std::string("scan"));
    finished = run({"config", file});
    EXPECT_EQ(finished.status, 0) << finished.err;
  }
  for (const char* file : {"my_own.lua", "my_film.lua"}) {
    const Finished finished = run({"run", file, "--quiet"});
    EXPECT_EQ(finished.status, 0) << file << finished.err;
  }
  refused({"new", "mission", "film", "my_film.lua"}, {"exists already"});
  refused({"new", "mission", "flim", "x.lua"}, {"did you mean 'film'?"});
  refused({"new", "mission", "film", "x.txt"}, {"expected one that ends in .lua"});
}

// A kind of mission that the library does not have, in under 80 lines.
TEST_F(NewFiles, AFacadeIsInspected) {
  const std::string script = LAPWING_SOURCE_DIR "/examples/facade/facade.lua";
  const std::string text = read_file(script);
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 80);
  Finished finished = run({"run", script, "--json"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(from_json(finished.out, "answer").at("kind").as_text(), "facade");
  finished = run({"run", script, "--set", "wall.width=6", "--set", "stand_off=7", "--quiet"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  refused({"run", script, "--set", "stand_of=3"}, {"did you mean 'stand_off'?"});
}

TEST_F(NewFiles, ASweepIsATable) {
  write("shot.lua", film("weights = { effort = 0.01 },"));
  Finished finished = run({"sweep", "shot.lua", "--vary", "weights.effort=0.01,1", "--vary",
                           "start_velocity=[0, 0, 0],[1, 0, 0]", "--set", "start=moving"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  const std::string table = finished.out.substr(0, finished.out.find("\n\n") + 1);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5) << finished.out;
  EXPECT_EQ(finished.out.rfind("run      weights.effort  start_velocity  status", 0), 0u)
      << finished.out;
  EXPECT_TRUE(fs::exists(folder_ / "out/sweep/run_004/plan.json"));
  finished = run({"sweep", "shot.lua", "--vary", "weights.effort=0.01,-1", "--json"});
  EXPECT_EQ(finished.status, 2);
  const Value answer = from_json(finished.out, "answer");
  EXPECT_EQ(answer.at("runs").as_list()[0].at("exit").as_integer(), 0);
  EXPECT_NE(answer.at("runs").as_list()[1].at("answer").at("error").as_text().find(
                "weights.effort: expected"),
            std::string::npos);
  refused({"sweep", "shot.lua", "--vary", "effort"}, {"expected KEY=VALUE,VALUE"});
}

}  // namespace
}  // namespace lapwing
