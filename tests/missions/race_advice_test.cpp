// SPDX-License-Identifier: Apache-2.0
// Races that the controller cannot follow, and what a user is told of them.
#include <gmock/gmock.h>

#include "framework/core/error.h"
#include "tests/missions/race_advice.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

TEST_F(RaceAdvice, NothingIsTriedWhereNobodyAsks) {
  EXPECT_TRUE(notes(race(turns("advise = false"))).empty());
  const Flown reported = race(turns("closed_loop = 'reported'"));
  EXPECT_TRUE(notes(reported).empty());
}

TEST_F(RaceAdvice, WhatNoThrustMendsIsSaid) {
  // Rotors that answer half a second late: no flight of this course is followed.
  const Flown flown = race(
      "vehicle = { mass = 0.85, inertia = {0.001, 0.001, 0.0017}, yaw_share = 0.1, flight_time = "
      "240, rotors = { thrust = {0, 6.879}, torque_coefficient = 0.05, arm_length = 0.15, lag = "
      "0.5 }, limits = { speed_across = 25, climb_speed = 15, descent_speed = 15, "
      "acceleration_across = 40, yaw_rate_deg = 171 }, camera = 'cameras/racing' }, refinements = "
      "0, start = {0, 0, 2}, finish = {6, 0, 2}, gates = { { shape = 'ball', position = {3, 3, 2}, "
      "radius = 0.3 } }");
  ASSERT_EQ(flown.status, 1);
  ASSERT_EQ(notes(flown).size(), 1u);
  EXPECT_THAT(notes(flown)[0], HasSubstr("no tried thrust from "));
}

TEST_F(RaceAdvice, PlansOfRotorsAreFlownAndRaced) {
  const std::string log = "time,forward,left\n0,0,0\n0.4,0,0\n0.8,0,0\n";
  write_file_atomically(folder_ / "still.csv", log);
  const Flown flown =
      race(turns("closed_loop = 'reported', players = { { log = 'still.csv', "
                 "weight = 0.1 } }"));
  ASSERT_LE(flown.status, 1) << to_json(flown.result);
  EXPECT_EQ(flown.result.at("game").at("pilots").as_list().size(), 1u);
  const std::string plan = (flown.folder / "plan.json").string();
  const auto status = [&](const std::string& arguments) {
    return WEXITSTATUS(std::system((std::string(LAPWING_BUILD_DIR) + "/bin/lapwing " + arguments +
                                    " > '" + (folder_ / "out.txt").string() + "' 2>&1")
                                       .c_str()));
  };
  EXPECT_LE(status("simulate '" + plan + "'"), 1) << read_file(folder_ / "out.txt");
  EXPECT_LE(status("race '" + plan + "' --pilot '" + (folder_ / "still.csv").string() + "'"), 1)
      << read_file(folder_ / "out.txt");
}

// The script computes its race, says so and waits until it is interrupted: the game cannot begin.
TEST_F(RaceAdvice, NothingComputedIsLostToAGameThatCannotBeFlown) {
  write_file_atomically(folder_ / "still.csv", "time,forward,left\n0,0,0\n0.4,0,0\n0.8,0,0\n");
  write_file_atomically(folder_ / "course.lua", R"(
local mission = require 'mission.race'.course { name = 'course', start = {0, 0, 2},
  finish = {6, 0, 2}, gates = { { shape = 'ball', position = {3, 1, 2}, radius = 0.3 } },
  players = { { log = 'still.csv' } } }
local plan = mission.plan
mission.plan = function(run)
  local result = plan(run)
  print 'all is computed'
  while not run:cancelled() do end
  return result
end
return mission)");
  const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing";
  const std::string typed =
      "cd '" + folder_.string() + "' && { '" + program +
      "' run course.lua --json --set sandbox.instructions=1000000000000 > answer.json 2> said.txt "
      "& } && child=$! && for i in $(seq 2000); do grep -q 'all is computed' said.txt && break; "
      "sleep 0.05; done && kill -TERM $child; wait $child";
  EXPECT_EQ(WEXITSTATUS(std::system(typed.c_str())), 130) << read_file(folder_ / "said.txt");
  const Value answer = from_json(read_file(folder_ / "answer.json"), "answer");
  const Value* game = answer.find("game");
  ASSERT_NE(game, nullptr) << to_json(answer);
  EXPECT_EQ(game->find("pilots"), nullptr);
  ASSERT_NE(game->find("not_flown"), nullptr) << to_json(*game);
  EXPECT_THAT(game->at("not_flown").as_text(),
              HasSubstr("interrupted; fly them with lapwing race"));
  // What was computed is whole, and says what became of the game.
  const fs::path folder = folder_ / "out/course";
  EXPECT_GT(read_plan(folder / "plan.json").trajectory.duration(), 1);
  EXPECT_THAT(read_file(folder / "report.html"), HasSubstr("the players did not fly: interrupted"));
  // What is said to do works.
  const std::string race = "cd '" + folder_.string() + "' && '" + program +
                           "' race out/course/plan.json --pilot still.csv > raced.txt 2>&1";
  EXPECT_LE(WEXITSTATUS(std::system(race.c_str())), 1) << read_file(folder_ / "raced.txt");
  EXPECT_THAT(read_file(folder_ / "raced.txt"), HasSubstr("still"));
}

TEST_F(RaceAdvice, AnUnreadableLogIsSaidBeforeAnythingIsComputed) {
  write_file_atomically(folder_ / "broken.csv", "time,forward,left\n0,0,0\n0.5,zero,0\n");
  const std::string said = refused(turns("players = { { log = 'broken.csv' } }"));
  EXPECT_THAT(said, HasSubstr("broken.csv:3:"));
  EXPECT_THAT(said, Not(HasSubstr("interior-point")));
}

TEST_F(RaceAdvice, ATypoInACourseNamesFileLineAndKey) {
  const auto said = [&](const std::string& text) {
    write_file_atomically(folder_ / "course.yaml", text);
    return refused("input = 'course.yaml'");
  };
  const std::string gate = "  - {shape: ball, position: [3, 3, 2], radius: 0.3}\n";
  const std::string begin = "start: [0, 0, 2]\nend: {position: [6, 0, 2]}\n";
  EXPECT_THAT(said(begin + "gatse:\n" + gate),
              HasSubstr("course.yaml:3: gatse: unknown key; did you mean 'gates'?"));
  EXPECT_THAT(said(begin + "gates:\n" + gate + "  - {shape: ball, positoin: [3, 3, 2]}\n"),
              HasSubstr("course.yaml:5: gates[2].positoin: unknown key; did you mean 'position'?"));
  EXPECT_THAT(said(begin + "gates:\n  - {shape: bal, position: [3, 3, 2], radius: 1}\n"),
              HasSubstr("did you mean 'ball'?"));
  EXPECT_THAT(
      said(begin + "gates:\n" + gate + "  - {shape: ball, position: [3, 3, 2], radius: 0}\n"),
      HasSubstr("course.yaml:5: gates[2].radius: a ball cannot be entered"));
  EXPECT_THAT(said("start: {positoin: [0, 0, 2]}\ngates:\n" + gate),
              HasSubstr("course.yaml:1: start.positoin: unknown key; did you mean 'position'?"));
  EXPECT_THAT(said(begin + "waypoints: [[1, 2, 3], [1, 2]]\n"),
              HasSubstr("course.yaml:3: waypoints[2]: expected three finite numbers"));
  const std::string all = said(
      "strat: [0, 0, 1]\nend:\n  positoin: [9, 0, 1]\ngates:\n  - {shpae: ball, position: [5, 0, "
      "2], "
      "radius: 1}\n  - {shape: ball, positoin: [5, 0, 2], raduis: 1}\n");
  EXPECT_THAT(all, HasSubstr("course.yaml:1: strat: unknown key; did you mean 'start'?"));
  EXPECT_THAT(all, HasSubstr("course.yaml:3: end.positoin: unknown key; did you mean 'position'?"));
  EXPECT_THAT(all, HasSubstr("course.yaml:5: gates[1].shpae: unknown key; did you mean 'shape'?"));
  EXPECT_THAT(all, HasSubstr("course.yaml:6: gates[2].positoin: unknown key"));
  EXPECT_THAT(all,
              HasSubstr("course.yaml:6: gates[2].raduis: unknown key; did you mean 'radius'?"));
  EXPECT_THAT(said("- 1\n"), HasSubstr("course.yaml:1: expected a table with the keys start"));
}

}  // namespace
}  // namespace lapwing
