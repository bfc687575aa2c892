// SPDX-License-Identifier: Apache-2.0
// The command line as a user meets it: the program run as a process of its own.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/plugin/abi.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

TEST_F(CommandLine, AFilmIsPlannedAndWritten) {
  write("Hop Süd.lua", film("name = 'Hop Süd-1.x',"));
  const Finished finished = run({"run", "Hop Süd.lua"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("Hop Süd-1.x: certified"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("report: out/hop_s_d-1_x/report.html"), std::string::npos)
      << finished.out;
  for (const char* name : {"plan.json", "report.html", "trajectory.csv", "run.log"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out/hop_s_d-1_x" / name)) << name;
  }
}

TEST_F(CommandLine, JsonIsOneObjectOfTheStatedShape) {
  write("shot.lua", film("name = 'hop',"));
  const Finished finished = run({"run", "shot.lua", "--json", "--seed", "7", "--threads", "2"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  const Value object = from_json(finished.out, "stdout");
  EXPECT_EQ(object.at("mission").as_text(), "hop");
  EXPECT_EQ(object.at("kind").as_text(), "film");
  EXPECT_EQ(object.at("status").as_text(), "ok");
  EXPECT_EQ(object.at("plan").as_text(), "out/hop/plan.json");
  EXPECT_EQ(object.at("seed").as_integer(), 7);
  EXPECT_GE(object.at("seconds").at("total").as_number(),
            object.at("seconds").at("solve").as_number());
  EXPECT_TRUE(object.at("reproducible").as_boolean());
  EXPECT_EQ(object.at("solver").at("name").as_text(), "iqp");
  EXPECT_EQ(object.at("solver").at("status").as_text(), "optimal");
  EXPECT_GE(object.at("solver").at("iterations").as_integer(), 1);
  EXPECT_GE(object.at("solver").at("terms").at("smoothness").as_number(), 0);
  EXPECT_TRUE(object.at("certificate").at("feasible").as_boolean());
  EXPECT_FALSE(object.at("certificate").at("checks").as_list().empty());
}

TEST_F(CommandLine, QuietSaysNothing) {
  write("shot.lua", "print('hello')\n" + film("name = 'hop',"));
  Finished finished = run({"run", "shot.lua", "--quiet", "--out", "there"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.out + finished.err, "");
  EXPECT_TRUE(fs::exists(folder_ / "there/plan.json"));
  EXPECT_NE(read_file(folder_ / "there/run.log").find("hello"), std::string::npos);
  finished = run({"run", "shot.lua"});
  EXPECT_NE(finished.err.find("hello\n"), std::string::npos);
}

TEST_F(CommandLine, TwoRunsGiveTheSameBytes) {
  write("shot.lua", film("name = 'hop', stretch = 1 + math.random(),"));
  run({"run", "shot.lua", "--out", "a", "--seed", "3"});
  run({"run", "shot.lua", "--out", "b", "--seed", "3", "--threads", "1"});
  run({"run", "shot.lua", "--out", "c", "--seed", "4"});
  const std::string plan = read_file(folder_ / "a/plan.json");
  EXPECT_EQ(plan, read_file(folder_ / "b/plan.json"));
  EXPECT_NE(plan, read_file(folder_ / "c/plan.json"));
  EXPECT_EQ(read_file(folder_ / "a/report.html"), read_file(folder_ / "b/report.html"));
}

TEST_F(CommandLine, AnOverConstrainedFilmNamesLimitAndTime) {
  write("shot.lua",
        "return require('mission.film').shot { name = 'dash', hard = 0.5, keyframes = {\n"
        "  { time = 0, position = {0, 0, 2} }, { time = 4, position = {60, 0, 2} } } }");
  Finished finished = run({"run", "shot.lua"});
  EXPECT_EQ(finished.status, 1) << finished.err;
  EXPECT_NE(finished.out.find("speed_across of 15 m/s from keyframe 1 to 2 exceeds 10 m/s at 0 s"),
            std::string::npos)
      << finished.out;
  EXPECT_NE(finished.out.find("certified from a stretch of"), std::string::npos);
  EXPECT_NE(read_file(folder_ / "out/dash/report.html").find("certified from a stretch of"),
            std::string::npos);
  finished = run({"run", "shot.lua", "--json"});
  EXPECT_EQ(finished.status, 1);
  const std::string status = from_json(finished.out, "stdout").at("status").as_text();
  EXPECT_TRUE(status == "infeasible" || status == "not_certified") << status;
  EXPECT_EQ(run({"verify", "out/dash/plan.json"}).status, 1);
  EXPECT_EQ(run({"run", "shot.lua", "--set", "stretch=auto"}).status, 0);
}

// Shapes are not in a plan document: they are opened again from what it records.
TEST_F(CommandLine, ExportsWithSurroundingsHoldEveryObstacle) {
  write("rock.obj", "v 0 20 0\nv 1 20 0\nv 0 21 0\nf 1 2 3\n");
  write("shot.lua", film("name = 'hop', obstacles = { { type = 'sphere', name = 'ball', "
                         "center = {0, 20, 3}, radius = 1 }, { type = 'mesh', name = 'rock', "
                         "file = 'rock.obj' } },"));
  const Finished made = run({"run", "shot.lua"});
  ASSERT_EQ(made.status, 0) << made.err;
  const Finished finished = run({"export", "out/hop/plan.json", "--format", "gltf", "-o", "x.glb"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.out.find("left out"), std::string::npos) << finished.out;
  const std::string file = read_file(folder_ / "x.glb");
  EXPECT_NE(file.find("\"ball\""), std::string::npos);
  EXPECT_NE(file.find("\"rock\""), std::string::npos);
}

TEST_F(CommandLine, VerifyAndExport) {
  write("shot.lua", film("name = 'hop',"));
  ASSERT_EQ(run({"run", "shot.lua"}).status, 0);
  Finished finished = run({"verify", "out/hop/plan.json"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.out.rfind("hop: certified\n", 0), 0u) << finished.out;
  finished = run({"verify", "out/hop/plan.json", "--json"});
  EXPECT_TRUE(from_json(finished.out, "stdout").at("certificate").at("feasible").as_boolean());
  finished = run({"export", "out/hop/plan.json", "--format", "csv", "-o", "hop.csv"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.out, "wrote hop.csv\n");
  for (const char* format : {"csv:", "csv:x", "gltf:frame_rate=24,frame_rate=25"})
    refused({"export", "out/hop/plan.json", "--format", format, "-o", "x"},
            {"--format: expected NAME or NAME:KEY=VALUE,..., each key once", format});
  write("ann.csv", "time,forward,left\n0,0,0\n0.4,0,0\n");
  refused({"race", "out/hop/plan.json", "--pilot", "ann.csv:handicp=3"},
          {"'handicp'", "did you mean 'handicap'?"});
  EXPECT_EQ(read_file(folder_ / "hop.csv"), read_file(folder_ / "out/hop/trajectory.csv"));
  refused({"export", "out/hop/plan.json", "--format", "cvs", "-o", "x.csv"}, {"'cvs'", "'csv'"});
  for (const char* of : {"map", "scene"})
    refused({of, "view", "street", "-o", "page.ot"}, {"'page.ot'", ".html"});
  refused({"simulate", "out/hop/plan.json", "-o", "page"}, {"'page'", ".html"});
  refused({"verify", "out/hop/plan.jsn"}, {"out/hop/plan.jsn"});
  const std::string plan = read_file(folder_ / "out/hop/plan.json");
  std::string changed = plan;
  const std::string verdict = "\"feasible\": true";
  ASSERT_NE(changed.find(verdict), std::string::npos);
  changed.replace(changed.find(verdict), verdict.size(), "\"feasible\": false");
  write("changed.json", changed);
  EXPECT_NE(run({"verify", "changed.json"}).err.find("changed after planning"), std::string::npos);
  write("cut.json", plan.substr(0, plan.size() / 2));
  refused({"verify", "cut.json"}, {"cut.json:"});
}

TEST_F(CommandLine, ConfigShowsValuesAndOrigins) {
  write("shot.lua", film("name = 'hop',"));
  write("mine.yaml", "weights:\n  yaw: 3\n");
  Finished finished = run({"config", "shot.lua", "--config", "mine.yaml", "--set", "order=3"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  for (const char* fragment : {"# film: hop", "mine.yaml:2", "# --set", "# default", "type: iqp",
                               "iterations: ", "shot.lua:4"}) {
    EXPECT_NE(finished.out.find(fragment), std::string::npos) << fragment << "\n" << finished.out;
  }
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  finished = run({"config", "shot.lua", "--json"});
  EXPECT_EQ(from_json(finished.out, "stdout").at("order").as_integer(), 4);
}

TEST_F(CommandLine, PluginsAreListedAndShown) {
  Finished finished = run({"plugins", "list"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_NE(finished.out.find("\ntrajectory_solver\n"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("\n  iqp "), std::string::npos) << finished.out;
  finished = run({"plugins", "list", "--json"});
  EXPECT_GT(from_json(finished.out, "stdout").at("plugins").as_list().size(), 8u);
  finished = run({"plugins", "show", "keyframe"});
  EXPECT_NE(finished.out.find("thesis 3.5.2"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("time"), std::string::npos);
  finished = run({"plugins", "show", "cost_term/keyframe", "--json"});
  EXPECT_EQ(from_json(finished.out, "stdout").at("plugins").as_list().size(), 1u);
  finished = run({"plugins", "show", "input_limits"});
  EXPECT_NE(finished.out.find("declares: invariant_to_translation, invariant_to_time"),
            std::string::npos)
      << finished.out;
  refused({"plugins", "show", "keyfrme"}, {"did you mean 'keyframe'?"});
  fs::create_directories(folder_ / "mine");
  finished = run({"plugins", "path", "--plugin-path", "mine"});
  EXPECT_EQ(finished.out.substr(0, finished.out.find('\n')).find("/lib/"), std::string::npos);
  EXPECT_NE(finished.out.find("mine\n"), std::string::npos) << finished.out << finished.err;
  EXPECT_NE(finished.out.find("/lib/plugins\n"), std::string::npos) << finished.out;
  refused({"--plugin-path", "/nowhere", "plugins", "path"}, {"/nowhere"});
}

TEST_F(CommandLine, UsageErrors) {
  refused({}, {"expected a command after 'lapwing'"});
  refused({"rnu", "shot.lua"}, {"unknown command 'rnu'; did you mean 'run'?"});
  refused({"plugins", "lst"}, {"unknown command 'lst'; did you mean 'list'?"});
  refused({"run"}, {"'lapwing run' wants MISSION.lua"});
  refused({"run", "shot.lua", "--sett", "a=b"}, {"--sett"});
  refused({"run", "shot.lua", "--seed", "x"}, {"--seed"});
  refused({"run", "shot.lua", "--seed", "-1"}, {"--seed"});
  refused({"run", "shot.lua", "--threads", "0"}, {"--threads"});
  refused({"run", "missing.lua"}, {"missing.lua"});
  write("shot.lua", film(""));
  refused({"run", "shot.lua", "--data", "nowhere"}, {"--data nowhere", "no such folder"});
  refused({"run", "shot.lua", "--config", "nothing"}, {"nothing"});
  refused({"run", "shot.lua", "--set", "weights"}, {"weights"});
  const Finished help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* command : {"run", "config", "plugins", "annotations", "schema"})
    EXPECT_NE(help.out.find(std::string("\n  ") + command), std::string::npos) << command;
  EXPECT_EQ(run({"--version"}).out.rfind("lapwing ", 0), 0u);
}

TEST_F(CommandLine, BadInputWithJsonIsStillOneObject) {
  write("shot.lua", film("wieghts = {},"));
  const Finished finished = run({"run", "shot.lua", "--json"});
  EXPECT_EQ(finished.status, 2);
  const Value object = from_json(finished.out, "stdout");
  EXPECT_EQ(object.at("status").as_text(), "failed");
  EXPECT_NE(object.at("error").as_text().find("shot.lua:7: wieghts: unknown key"),
            std::string::npos);
}

// Documents are JSON, and JSON is UTF-8: what is not is refused before anything is done.
TEST_F(CommandLine, TextThatIsNotUtf8IsRefused) {
  write("shot.lua", film(""));
  for (const std::vector<std::string>& typed :
       {std::vector<std::string>{"run", "shot.lua", "--set", "name=\xff", "--json"},
        {"run", "\xff.lua", "--json"},
        {"evaluate", "explore", "--world", "a\xff.obj", "--json"}}) {
    const Finished finished = run(typed);
    EXPECT_EQ(finished.status, 2) << finished.err;
    EXPECT_NE(from_json(finished.out, "stdout").at("error").as_text().find("not UTF-8"),
              std::string::npos);
  }
  EXPECT_EQ(run({"run", "\xc3\xbc.lua"}).status, 2);  // UTF-8, and no file
}

// Everything that can be wrong with a mission: one clear message, exit 2, nothing written.
TEST_F(CommandLine, BadMissionsAreRefused) {
  refused_script(film("wieghts = {},"), {"shot.lua:7: wieghts: unknown key", "'weights'"});
  refused_script(film("solver = 'ipq',"), {"shot.lua:7", "'ipq'", "'iqp'"});
  refused_script(film("duration = '3 kg',"),
                 {"shot.lua:7: duration: '3 kg' is not a quantity in s"});
  refused_script(film("hard = -0.5,"), {"shot.lua:7: hard: expected above 0 m, got -0.5"});
  refused_script(film("hard = 0/0,"), {"shot.lua:2: hard: expected a finite number, got NaN"});
  refused_script(
      "\nreturn require('mission.film').shot { keyframes = {"
      "{time=5, position={0,0,2}}, {time=3, position={1,0,2}} } }",
      {"shot.lua:2: keyframes[2].time: 3 s comes before keyframe 1 at 5 s"});
  refused_script(
      "\nreturn require('mission.film').shot { duration = 4, keyframes = {"
      "{time=0, position={0,0,2}}, {time=5, position={1,0,2}} } }",
      {"shot.lua:2: keyframes[2].time: 5 s is outside the duration of 4 s"});
  refused_script("return require('mission.film').from_file { file = 'none.json' }",
                 {"shot.lua:1", "'none.json' not found"});
  write("cut.json", "{\"keyFrameList\": [");
  refused_script("return require('mission.film').from_file { file = 'cut.json' }", {"cut.json:1"});
  fs::remove(folder_ / "cut.json");
  refused_script("local film = require 'mission.flim'", {"shot.lua:1: module 'mission.flim' not"});
  refused_script("return {\n  kind = 'film'\n  name = 'x' }", {"shot.lua:3: '}' expected"});
  refused_script("local a\n\na.b = 3", {"shot.lua:3: attempt to index a nil value"});
  refused_script("while true do end", {"shot.lua:1: ", "raise sandbox."});
  write("shot.lua", "while true do pcall(function() while true do end end) end");
  refused({"run", "shot.lua", "--set", "sandbox.instructions=1000000"},
          {"shot.lua:1: ", "raise sandbox.instructions"});
  write("shot.lua", "local t = {}\nwhile true do t[#t + 1] = ('x'):rep(100000) .. #t end");
  refused({"run", "shot.lua", "--set", "sandbox.memory=16"},
          {"shot.lua:2: ", "raise sandbox.memory"});
  refused_script("\x1bLua\x54", {"shot.lua:1: this is precompiled Lua"});
  refused_script("\nos.execute('touch pwned')", {"shot.lua:2: attempt to index a nil value"});
  refused_script("\nio.open('pwned', 'w')", {"shot.lua:2: attempt to index a nil value"});
  refused_script("lapwing.read_json('/etc/passwd')", {"shot.lua:1: ", "'/etc/passwd' not found"});
  refused_script("return 3", {"shot.lua:1: a mission script returns"});
  refused_script("", {"a mission script returns"});
  write("bad.yaml", "weights:\n  yaw: [\n");
  write("shot.lua", film(""));
  refused({"run", "shot.lua", "--config", "bad.yaml"}, {"bad.yaml:"});
  write("bad.yaml", "weights:\n  yaww: 1\nstep: 3 m\n");
  refused({"run", "shot.lua", "--config", "bad.yaml"},
          {"bad.yaml:2: weights.yaww: unknown key; did you mean 'yaw'?",
           "bad.yaml:3: step: '3 m' is not a quantity in s"});
  refused({"run", "shot.lua", "--set", "solver.iteration=3"},
          {"--set solver.iteration=3: solver.iteration: unknown key; did you mean 'iterations'?"});
  refused({"run", "shot.lua", "--set", "sandbox.memroy=3"}, {"did you mean 'memory'?"});
}

TEST_F(CommandLine, TheUsersOwnFileMayLieAnywhere) {
  write("elsewhere/own.json",
        R"({"keyframeTimes": [0, 8], "refLLH": {"lat": 47, "lng": 8, "altitude": 400},
            "keyFrameList": [{"lookFromNED": {"n": 0, "e": 0, "d": -5}},
                             {"lookFromNED": {"n": 0, "e": 9, "d": -8}}]})");
  write("missions/own.lua", "return require('mission.film').from_file { name = 'own' }");
  EXPECT_EQ(run({"run", "missions/own.lua", "--set", "input=elsewhere/own.json"}).status, 0);
  fs::remove_all(folder_ / "out");
  // A script may not name it itself.
  write("missions/own.lua",
        "return require('mission.film').from_file { file = '../elsewhere/own.json' }");
  refused({"run", "missions/own.lua"}, {"missions/own.lua:1", "'..' is not allowed"});
}

TEST_F(CommandLine, LimitsCanBeRaised) {
  write("shot.lua", "local n = 0 for i = 1, 100000 do n = n + 1 end\n" + film("name = 'hop',"));
  const Finished finished = run({"run", "shot.lua", "--set", "sandbox.instructions=1000"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("raise sandbox.instructions"), std::string::npos);
  write("limits.yaml", "sandbox: {instructions: 10000000}\n");
  EXPECT_EQ(run({"run", "shot.lua", "--config", "limits.yaml"}).status, 0);
}

TEST_F(CommandLine, APluginOfAnotherAbiIsRefused) {
  // The solver under another name, its tag altered in the library and in the sidecar.
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
    return text;
  };
  const fs::path original = fs::path(LAPWING_BUILD_DIR) / "lib/plugins/trajectory_solvers";
  std::string sidecar = read_file(original / "iqp.json");
  sidecar = replaced(replaced(sidecar, "\"iqp\"", "\"alien\""), "iqp.so", "alien.so");
  const std::string tag = kAbiTag, number = tag.substr(0, tag.find(';') + 1);
  write("plugins/alien.json", replaced(sidecar, number, "lapwing 9;"));
  write("plugins/alien.so", replaced(read_file(original / "iqp.so"), number, "lapwing 9;"));
  write("shot.lua", film("solver = 'alien',"));
  refused({"--plugin-path", "plugins", "run", "shot.lua"},
          {"shot.lua:2: ", "plugins/alien.so", "lapwing 9;", number, "rebuild the plugin"});
}

TEST_F(CommandLine, CtrlCKeepsTheBestSoFar) {
  // A film that is never certified searches long for a stretch.
  write("shot.lua", R"(
local film = require "mission.film"
local mission = film.shot { name = "long", hard = 0.01, keyframes = {
  { time = 0, position = {0, 0, 2} }, { time = 20, position = {90, 0, 2} } } }
local plan = mission.plan
mission.plan = function(run)
  local result
  while not run:cancelled() do
    result = plan(run)
    print('planned')
  end
  return result
end
return mission)");
  const pid_t child = start({"run", "shot.lua", "--json"});
  EXPECT_TRUE(speaks());
  ::kill(child, SIGINT);
  const Finished finished = finish(child);
  EXPECT_EQ(finished.status, 130) << finished.err;
  const Value object = from_json(finished.out, "stdout");
  EXPECT_EQ(object.at("status").as_text(), "cancelled");
  EXPECT_FALSE(object.at("reproducible").as_boolean());
  EXPECT_TRUE(fs::exists(folder_ / "out/long/plan.json"));
  EXPECT_NE(read_file(folder_ / "out/long/report.html").find("cancelled"), std::string::npos);
}

TEST_F(CommandLine, TheSecondCtrlCEndsAtOnce) {
  write("shot.lua", "print('begun') while true do end");
  const pid_t child = start(
      {"run", "shot.lua", "--set", "sandbox.instructions=1e14", "--set", "sandbox.seconds=100"});
  EXPECT_TRUE(speaks());
  ::kill(child, SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  ::kill(child, SIGINT);
  EXPECT_EQ(finish(child).status, 130);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace lapwing
