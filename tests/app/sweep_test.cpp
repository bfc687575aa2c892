// SPDX-License-Identifier: Apache-2.0
// lapwing sweep: what it prints and writes, how it ends, how it goes on.
#include <signal.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class Sweeping : public CommandLine {
 protected:
  static std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += part.size()) ++count;
    return count;
  }
  static bool appears(const fs::path& file) {
    return becomes([&] { return fs::exists(file); });
  }
  // Processes that run this test's sweep.
  int processes_of_runs() const {
    int count = 0;
    for (const auto& item : fs::directory_iterator("/proc")) {
      std::ifstream words(item.path() / "cmdline");
      const std::string line{std::istreambuf_iterator<char>(words), {}};
      std::error_code code;
      if (line.find("run_0") != line.npos &&
          fs::read_symlink(item.path() / "cwd", code) == fs::canonical(folder_))
        ++count;
    }
    return count;
  }
};

TEST_F(Sweeping, SaysWhatEveryRunCameTo) {
  write("shot.lua", film("name = 'hop', hard = 0.01, obstacles = { { type = 'sphere', "
                         "center = {2, 3, 2}, radius = 1 } },"));
  const Finished finished = run({"sweep", "shot.lua", "--vary", "weights.smoothness=0.001,0.1",
                                 "--vary", "duration=4,0.5", "--jobs", "3"});
  EXPECT_EQ(finished.status, 1) << finished.err;
  EXPECT_EQ(finished.out.rfind("run      weights.smoothness  duration  status", 0), 0u)
      << finished.out;
  for (const char* part :
       {"run_001", "run_004", "certified", "cost", "flight [s]", "path [m]", "clearance [m]",
        "nearest limit", "Cost of each term", "smoothness", "table: out/sweep/table.csv"})
    EXPECT_NE(finished.out.find(part), std::string::npos) << part << "\n" << finished.out;
  // What is too short for the vehicle says why.
  const std::size_t failure = finished.out.find("\nrun_002: ");
  ASSERT_NE(failure, std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("exceeds", failure), std::string::npos) << finished.out;
  EXPECT_EQ(finished.out.find('\x1b'), std::string::npos);
  std::size_t longest = 0, begin = 0;
  for (std::size_t end; (end = finished.out.find('\n', begin)) != std::string::npos;
       begin = end + 1)
    if (finished.out.substr(begin, 2) != "  ") longest = std::max(longest, end - begin);
  EXPECT_LE(longest, 100u) << finished.out;
  const std::string csv = read_file(folder_ / "out/sweep/table.csv");
  EXPECT_EQ(count_of(csv, "\n"), 5u);
  EXPECT_EQ(csv.rfind("run,weights.smoothness,duration,status,exit,cost,duration_s,path_length_m,"
                      "clearance_m,solve_seconds,nearest_limit,nearest_limit_share,cost.",
                      0),
            0u)
      << csv;
  const std::string page = read_file(folder_ / "out/sweep/report.html");
  for (const char* part : {"Paths from above", "run_003: weights.smoothness=0.1, duration=4"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
}

TEST_F(Sweeping, JsonHoldsTheFigures) {
  write("shot.lua", film("name = 'hop',"));
  const Finished finished =
      run({"sweep", "shot.lua", "--vary", "weights.effort=0.01,-1", "--json"});
  EXPECT_EQ(finished.status, 2);
  const Value answer = from_json(finished.out, "answer");
  const Value& good = answer.at("runs").as_list()[0];
  EXPECT_EQ(good.at("status").as_text(), "ok");
  EXPECT_GT(good.at("figures").at("path_length").as_number(), 5);
  EXPECT_GT(good.at("figures").at("terms").at("smoothness").as_number(), 0);
  EXPECT_GT(good.at("figures").at("nearest_limit").at("share").as_number(), 0.1);
  EXPECT_TRUE(good.at("reasons").as_list().empty());
  const Value& bad = answer.at("runs").as_list()[1];
  EXPECT_TRUE(bad.at("figures").is_null());
  EXPECT_EQ(bad.at("reasons").as_list().size(), 1u);
  EXPECT_NE(bad.at("reasons").as_list()[0].as_text().find("weights.effort"), std::string::npos);
}

// A mission that plans until it is told to stop, unless `step` is 0.2.
constexpr const char* kLong = R"(
local film = require "mission.film"
local mission = film.shot { name = "long", keyframes = {
  { position = {0, 0, 2} }, { position = {5, 0, 3} } } }
local plan = mission.plan
mission.plan = function(run)
  local result = plan(run)
  while run.options.step ~= 0.2 and not run:cancelled() do result = plan(run) end
  return result
end
return mission)";

TEST_F(Sweeping, EndsItsRunsWhenItIsEnded) {
  for (const int signal : {SIGINT, SIGTERM}) {
    write("shot.lua", kLong);
    const pid_t child = start({"sweep", "shot.lua", "--vary", "step=0.2,0.1,0.15", "--jobs", "1"});
    ASSERT_TRUE(appears(folder_ / "out/sweep/run_001/exit.txt"));
    ASSERT_TRUE(appears(folder_ / "out/sweep/run_002/answer.json"));
    ::kill(child, signal);
    const Finished finished = finish(child);
    EXPECT_EQ(finished.status, 130) << finished.err;
    EXPECT_NE(finished.out.find("run_001  0.2   certified"), std::string::npos) << finished.out;
    EXPECT_NE(finished.out.find("run_003  0.15  not run"), std::string::npos) << finished.out;
    EXPECT_EQ(processes_of_runs(), 0);
    EXPECT_TRUE(fs::exists(folder_ / "out/sweep/table.csv"));
    fs::remove_all(folder_ / "out");
  }
}

// The second would remove the runs of the first.
TEST_F(Sweeping, TwoIntoOneFolderDoNotMix) {
  write("shot.lua", kLong);
  const pid_t child = start({"sweep", "shot.lua", "--vary", "step=0.2,0.1", "--jobs", "1"});
  ASSERT_TRUE(appears(folder_ / "out/sweep/run_001/exit.txt"));
  ASSERT_TRUE(appears(folder_ / "out/sweep/run_002/answer.json"));
  const std::string statement = read_file(folder_ / "out/sweep/sweep.json");
  for (const char* resume : {"", "--resume"}) {
    // Its output goes elsewhere than that of the first.
    const std::string command = "cd '" + folder_.string() +
                                "' && " LAPWING_BUILD_DIR
                                "/bin/lapwing sweep shot.lua --vary step=0.2 " +
                                resume + " > second.txt 2>&1";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 2) << resume;
    const std::string said = read_file(folder_ / "second.txt");
    EXPECT_NE(said.find("another process is writing into 'out/sweep'"), said.npos) << said;
  }
  EXPECT_EQ(read_file(folder_ / "out/sweep/sweep.json"), statement);
  EXPECT_TRUE(fs::exists(folder_ / "out/sweep/run_001/plan.json"));
  EXPECT_EQ(processes_of_runs(), 1);
  ::kill(child, SIGINT);
  const Finished finished = finish(child);
  EXPECT_EQ(finished.status, 130) << finished.err;
  EXPECT_NE(finished.out.find("run_001  0.2   certified"), std::string::npos) << finished.out;
  // Nobody has it any more.
  const Finished next = run({"sweep", "shot.lua", "--vary", "step=0.2"});
  EXPECT_EQ(next.status, 0) << next.err;
  EXPECT_FALSE(fs::exists(folder_ / "out/sweep/run_002"));
}

TEST_F(Sweeping, KilledItLeavesNoRunBehind) {
  write("shot.lua", kLong);
  const pid_t child = start({"sweep", "shot.lua", "--vary", "step=0.1,0.15"});
  ASSERT_TRUE(appears(folder_ / "out/sweep/run_002/answer.json"));
  ::kill(child, SIGKILL);
  finish(child);
  EXPECT_TRUE(becomes([&] { return processes_of_runs() == 0; }));
}

TEST_F(Sweeping, GoesOnWithWhatIsMissing) {
  write("shot.lua", film("name = 'hop',"));
  const std::vector<std::string> typed{"sweep", "shot.lua", "--vary", "weights.effort=0.01,0.1,1"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = typed;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  refused(with({"--resume"}), {"--resume: there is no sweep in 'out/sweep'"});
  ASSERT_EQ(run(typed).status, 0);
  const auto time = [&](const char* file) { return fs::last_write_time(folder_ / file); };
  const std::string second = read_file(folder_ / "out/sweep/run_002/plan.json");
  const auto kept = time("out/sweep/run_001/plan.json");
  // As a kill leaves it: begun, without its end.
  fs::remove(folder_ / "out/sweep/run_002/exit.txt");
  fs::remove(folder_ / "out/sweep/run_002/plan.json");
  fs::remove_all(folder_ / "out/sweep/run_003");
  const Finished finished = run(with({"--resume", "--json"}));
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(from_json(finished.out, "answer").at("runs").as_list().size(), 3u);
  EXPECT_EQ(read_file(folder_ / "out/sweep/run_002/plan.json"), second);
  EXPECT_TRUE(fs::exists(folder_ / "out/sweep/run_003/plan.json"));
  EXPECT_EQ(time("out/sweep/run_001/plan.json"), kept);

  // Of something else it is another sweep.
  Finished other = run(with({"--resume", "--seed", "2"}));
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("has other inputs: seed"), std::string::npos) << other.err;
  other = run(with({"--resume", "--set", "hard=0.1"}));
  EXPECT_NE(other.err.find("other inputs: set"), std::string::npos) << other.err;
  write("shot.lua", film("name = 'hop', hard = 0.3,"));
  other = run(with({"--resume"}));
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("other inputs: scripts_sha256"), std::string::npos) << other.err;
  other = run(typed);
  EXPECT_EQ(other.status, 0);
  EXPECT_NE(other.err.find("replaces the sweep in 'out/sweep'"), std::string::npos) << other.err;
}

TEST_F(Sweeping, WhatNoRunCouldDoIsRefusedBefore) {
  write("shot.lua", film("name = 'hop',"));
  refused({"sweep", "shot.lua", "--vary", "weights.efort=1,2"},
          {"lapwing: --vary: weights.efort: unknown key; did you mean 'effort'?"});
  refused({"sweep", "nothing.lua", "--vary", "step=0.1"}, {"there is no script 'nothing.lua'"});
  refused({"sweep", "shot.lua"}, {"expected --vary KEY=VALUE,VALUE,..."});
  refused({"sweep", "shot.lua", "--vary", "step=0.1", "--set", "hard=x"}, {"--set hard=x: hard"});
}

// A module of one's own counts as the script does.
TEST_F(Sweeping, ItsOwnModulesCount) {
  write("sizes.lua", "return { hard = 0.3 }");
  write("shot.lua", "local sizes = require 'sizes'\n" + film("hard = sizes.hard,"));
  ASSERT_EQ(run({"sweep", "shot.lua", "--vary", "step=0.1"}).status, 0);
  write("sizes.lua", "return { hard = 0.4 }");
  const Finished finished = run({"sweep", "shot.lua", "--vary", "step=0.1", "--resume"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("scripts_sha256"), std::string::npos) << finished.err;
}

// What no sweep wrote, and in the folder that nobody named the sweep of another script.
TEST_F(Sweeping, ReplacesNothingElse) {
  write("shot.lua", film("name = 'hop',"));
  write("other.lua", film("name = 'other',"));
  ASSERT_EQ(run({"run", "shot.lua", "-o", "mine"}).status, 0);
  const std::string page = read_file(folder_ / "mine/report.html");
  Finished finished = run({"sweep", "shot.lua", "--vary", "duration=4", "-o", "mine"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("which no sweep wrote"), std::string::npos) << finished.err;
  EXPECT_EQ(read_file(folder_ / "mine/report.html"), page);
  EXPECT_FALSE(fs::exists(folder_ / "mine/sweep.json"));
  ASSERT_EQ(run({"sweep", "shot.lua", "--vary", "duration=4"}).status, 0);
  const std::string table = read_file(folder_ / "out/sweep/table.csv");
  finished = run({"sweep", "other.lua", "--vary", "duration=4"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("contains the sweep of 'shot.lua'"), std::string::npos)
      << finished.err;
  EXPECT_EQ(read_file(folder_ / "out/sweep/table.csv"), table);
  EXPECT_EQ(run({"sweep", "other.lua", "--vary", "duration=4", "-o", "out/sweep"}).status, 0);
}

// Neither the names of data files nor their folders tell that one has changed.
TEST_F(Sweeping, FilesThatRunsReadCount) {
  fs::create_directories(folder_ / "data");
  write("data/goal.yaml", "x: 5\n");
  write("own.yaml", read_file(fs::path(LAPWING_SOURCE_DIR) / "configs/vehicles/solo.yaml"));
  write("shot.lua",
        "local film = require 'mission.film'\nlocal mission = film.shot { keyframes = {\n"
        "  { position = {0, 0, 2} }, { position = {5, 0, 3} } }, duration = 4 }\n"
        "local plan = mission.plan\n"
        "mission.plan = function(run) lapwing.read_yaml('goal.yaml') return plan(run) end\n"
        "return mission\n");
  const std::vector<std::string> typed{"sweep",        "shot.lua",         "--vary",
                                       "step=0.1,0.2", "--data",           "data",
                                       "--set",        "vehicle=own.yaml", "--resume"};
  std::vector<std::string> first = typed;
  first.pop_back();
  ASSERT_EQ(run(first).status, 0);
  const fs::path inputs = folder_ / "out/sweep/run_001/inputs.json";
  const Value sums = from_json(read_file(inputs), "inputs");
  EXPECT_EQ(sums.as_map().size(), 2u) << to_json(sums);
  const auto kept = fs::last_write_time(folder_ / "out/sweep/run_001/plan.json");
  EXPECT_EQ(run(typed).status, 0) << "nothing has changed";
  EXPECT_EQ(fs::last_write_time(folder_ / "out/sweep/run_001/plan.json"), kept);
  const auto resumed_after = [&](const std::string& file, const std::string& more) {
    const std::string before = read_file(folder_ / file);
    write(file, before + more);
    fs::remove(folder_ / "out/sweep/run_002/exit.txt");
    const Finished finished = run(typed);
    EXPECT_EQ(finished.status, 2) << file;
    EXPECT_NE(finished.err.find(file + "', which run_001 read, has changed since"),
              std::string::npos)
        << finished.err;
    EXPECT_TRUE(fs::exists(folder_ / "out/sweep/run_002/plan.json")) << "something was removed";
    write(file, before);
  };
  resumed_after("data/goal.yaml", "y: 1\n");
  resumed_after("own.yaml", "# other\n");
  EXPECT_EQ(run(typed).status, 0) << "all is as it was";
}

// Of a run without a plan it is not known what it read.
TEST_F(Sweeping, RunsWithoutAPlanAreDoneAgain) {
  fs::create_directories(folder_ / "data");
  write("data/goal.yaml", "y: 5\n");
  write("shot.lua",
        "local film = require 'mission.film'\nlocal mission = film.shot { keyframes = {\n"
        "  { position = {0, 0, 2} }, { position = {5, 0, 3} } }, duration = 4 }\n"
        "local plan = mission.plan\n"
        "mission.plan = function(run)\n"
        "  if not lapwing.read_yaml('goal.yaml').x then error('no x') end return plan(run) end\n"
        "return mission\n");
  ASSERT_EQ(run({"sweep", "shot.lua", "--vary", "step=0.1", "--data", "data"}).status, 2);
  write("data/goal.yaml", "x: 5\n");
  const Finished finished =
      run({"sweep", "shot.lua", "--vary", "step=0.1", "--data", "data", "--resume"});
  EXPECT_EQ(finished.status, 0) << finished.err;
}

// A plugin that was built anew is another one.
TEST_F(Sweeping, LibrariesOfPluginsCount) {
  write("shot.lua", film("name = 'hop', duration = 4,"));
  const std::vector<std::string> typed{"sweep", "shot.lua", "--vary", "step=0.1"};
  ASSERT_EQ(run(typed).status, 0);
  const fs::path file = folder_ / "out/sweep/sweep.json";
  Value statement = from_json(read_file(file), "sweep.json");
  const Value* sums = statement.find("plugins_sha256");
  ASSERT_NE(sums, nullptr);
  ASSERT_NE(sums->find("cost_term derivative"), nullptr) << to_json(*sums);
  EXPECT_EQ(sums->at("cost_term derivative").as_text().size(), 64u);
  statement.find("plugins_sha256")->set("cost_term derivative", std::string(64, '0'));
  write_file_atomically(file, to_json(statement));
  std::vector<std::string> again = typed;
  again.push_back("--resume");
  const Finished finished = run(again);
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("other inputs: plugins_sha256"), std::string::npos) << finished.err;
}

}  // namespace
}  // namespace lapwing
