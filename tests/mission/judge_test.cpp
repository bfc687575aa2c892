// SPDX-License-Identifier: Apache-2.0
// Judging a mission finds what planning would refuse before it begins, and plans nothing.
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

class Judging : public MissionTest {
 protected:
  // The message of judging the mission of `text`, or "right".
  std::string judged(const std::string& text, std::vector<std::string> overrides = {}) {
    try {
      const auto mission = load(text);
      mission->configure({}, overrides);
      mission->judge();
      began_ = mission->planning_began();
      return "right";
    } catch (const InputError& error) {
      return error.what();
    }
  }
  bool began_ = false;
};

TEST_F(Judging, EndsWherePlanningBegins) {
  const auto mission = load(film(""));
  mission->configure({}, {});
  EXPECT_FALSE(mission->planning_began());
  mission->judge();
  EXPECT_TRUE(mission->planning_began());
  // A mission that was judged can be planned.
  EXPECT_EQ(mission->plan().report.status, SolveStatus::optimal);
}

TEST_F(Judging, ReadsTheFilesOfAMission) {
  const std::string race = "return require('mission.race').course { input = 'course.yaml' }";
  EXPECT_NE(judged(race).find("course.yaml"), std::string::npos);
  write_file_atomically(folder_ / "course.yaml",
                        "start: [0, 0, 1]\nend: [9, 0, 1]\ngates:\n  - {shape: ball, position: [4, "
                        "0, 2], raduis: 1}\n");
  EXPECT_NE(judged(race).find("course.yaml:4: gates[1].raduis: unknown key"), std::string::npos);
  EXPECT_NE(judged(film("obstacles = { { type = 'mesh', file = 'house.obj' } },"))
                .find("'house.obj' not found"),
            std::string::npos);
  write_file_atomically(folder_ / "house.obj", "hello");
  EXPECT_NE(judged(film("obstacles = { { type = 'mesh', file = 'house.obj' } },")), "right");
  write_file_atomically(folder_ / "a.svg", "<svg");
  EXPECT_NE(judged("return require('mission.light_painting').picture { svg = 'a.svg' }"), "right");
  EXPECT_NE(judged("return require('mission.scan').of_mesh {}").find("no scene: name a scene"),
            std::string::npos);
}

TEST_F(Judging, ASettingTooLargeToSolveIsRefused) {
  EXPECT_NE(judged("return require('mission.light_painting').text { text = 'LONG WORDS', step = "
                   "0.005, speed = 0.1 }")
                .find("more than 3000 stages"),
            std::string::npos);
}

// What a script does with the error that ends it is no error of its own.
TEST_F(Judging, AScriptThatGoesOnIsRight) {
  const std::string stated =
      "return { kind = 'own', plan = function(run)\n"
      "local p = run:problem { vehicle = run:vehicle('vehicles/solo'), duration = 4, step = 0.2 }\n"
      "p:add_model { type = 'quadrotor' }\np:add_cost { type = 'yaw_derivative', weight = 0.1 }\n"
      "p:finish()\n";
  EXPECT_EQ(judged(stated + "local fine, solution = pcall(run.solve, run, p, 'iqp')\n"
                            "return run:plan { solution = solution } end }"),
            "right");
  EXPECT_TRUE(began_);
  EXPECT_NE(judged(stated + "error('before it plans')\nend }").find("before it plans"),
            std::string::npos);
  EXPECT_NE(
      judged("return { kind = 'own', plan = function(run) end }").find("expected the function"),
      std::string::npos);
}

}  // namespace
}  // namespace lapwing
