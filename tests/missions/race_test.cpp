// SPDX-License-Identifier: Apache-2.0
// Races end to end: certified, in time, refused with a reason.
#include "tests/missions/race_fixture.h"

namespace lapwing {
namespace {

TEST_F(Race, ThreeGatesAtTheLimitOfTheRotors) {
  const Flown flown = fly("../racing/round_course.lua", "--set model=quadrotor_full --set laps=1");
  expect_flown_by_rotors(flown, 3);
}

TEST_F(Race, APointMassAsFastAsOthers) {
  if (!has_tracks()) GTEST_SKIP() << "LAPWING_DATA names no folder with tracks";
  for (const auto& [name, seconds] : {std::pair{"eight", 8.945}, {"slalom", 11.186}}) {
    const Flown flown = race(std::string(kPoint) +
                             "thrust = 1, tolerance = 0.01, closed_loop = 'reported', input = "
                             "'tracks/" +
                             name + ".yaml'");
    expect_certified(flown);
    EXPECT_LE(time_of(flown), 1.02 * seconds) << name;
  }
}

TEST_F(Race, RoundAndRoundClosesOntoItsBeginning) {
  const Flown flown = fly("../racing/round_course.lua");
  expect_certified(flown);
  const Trajectory trajectory = read_plan(flown.folder / "plan.json").trajectory;
  const Sample &first = trajectory.samples.front(), &last = trajectory.samples.back();
  EXPECT_LT((first.position - last.position).norm(), 1e-5);
  EXPECT_LT((first.velocity - last.velocity).norm(), 1e-5);
  EXPECT_GT(first.velocity.norm(), 1);
}

TEST_F(Race, FiftyRandomKeyframes) {
  expect_within_limits(race(keyframes(random_keyframes(1)) + kGentle));
}

TEST_F(Race, DegenerateKeyframesAreFlown) {
  const Eigen::Vector3d a(0, 0, 1), b(4, 0, 1), c(8, 0, 1), d(8, 5, 1);
  for (const auto& points : std::vector<std::vector<Eigen::Vector3d>>{
           {a}, {a, a}, {a, a, b, b, b, a}, {a, b, c}, {a, c, b}, {a, b, c, d}, {a, d, a, d}})
    for (const char* timing : {kGentle, "tolerance = 0.05, step = 0.1,"}) {
      const Flown flown = race(keyframes(points) + timing);
      expect_certified(flown);
    }
}

TEST_F(Race, AFreeFormCourseRepeatsItself) {
  const std::string course = "free_form = { length = 60, curvature = 0.15 }, time = 12,";
  const Flown first = race(course, "--seed 7");
  expect_certified(first);
  EXPECT_NEAR(time_of(first), 12, 1e-6);
  const std::string plan = read_file(first.folder / "plan.json");
  race(course, "--seed 7");
  EXPECT_EQ(read_file(first.folder / "plan.json"), plan);
}

TEST_F(Race, SolversAgree) {
  const std::string rotors = "--set model=quadrotor_full --set laps=1 --set closed_loop=reported";
  const Flown ipopt = fly("../racing/round_course.lua", rotors + " --set solver=ipopt");
  const Flown iqp = fly("../racing/round_course.lua", rotors);
  expect_flown_by_rotors(iqp, 3);
  EXPECT_NEAR(time_of(iqp), time_of(ipopt), 0.005 * time_of(ipopt));
}

TEST_F(Race, OtherSolversSayWhichOneToTake) {
  const Flown flown = fly("../racing/seven_gates.lua", "--set solver=nlopt");
  EXPECT_EQ(flown.status, 1);
  EXPECT_EQ(flown.result.at("solver").at("status").as_text(), "unsupported");
  EXPECT_NE(flown.result.at("notes").as_list().at(0).as_text().find("use the solver iqp"),
            std::string::npos);
}

TEST_F(Race, BadCoursesAreRefused) {
  const std::string ball = "{ shape = 'ball', position = {5, 0, 2}, radius = 0.5 }";
  const std::string gate =
      "shape = 'rectangle', position = {5, 0, 2}, normal_yaw_deg = 0, width = 2";
  const auto course = [&](const std::string& gates, const std::string& more = "") {
    return refused("start = {0, 0, 2}, finish = {9, 0, 2}, gates = {" + gates + "}, " + more);
  };
  const std::vector<std::pair<std::string, const char*>> cases = {
      {course("{ shape = 'star', position = {1, 2, 3} }"), "'star'"},
      {course("{ " + gate + " }"), "width and height"},
      {course("{ " + gate + ", height = 0 }"), "cannot be entered"},
      {course("{ " + gate + ", height = -1 }"), "cannot be entered"},
      {course("{ shape = 'ball', position = {0/0, 0, 0}, radius = 1 }"), "finite"},
      {course("{ shape = 'rectangle', position = {5, 0, 2}, width = 2, height = 2 }"),
       "normal_yaw_deg"},
      {course("{ shape = 'rectangle', position = {5, 0, 2}, normal_yaw = 0, height = 2 }"),
       "normal_yaw: unknown key; did you mean 'normal_yaw_deg'?"},
      {course("{ " + gate + ", height = 2 }, { " + gate + ", height = 1 }"), "overlap at"},
      {course(ball, "floor = 3"), "start: 2 m above the ground"},
      {course(ball, "floor = 1.5, start = {0, 0, 1}"), "start"},
      {course("{ shape = 'ball', position = {5, 0, 1}, radius = 0.2 }", "floor = 1.5"),
       "cannot be entered"},
      {course(ball, "laps = 3"), "closed course"},
      {course(ball, "keyframes = { { position = {1, 2, 3} } }"), "gates and keyframes"},
      {course(ball, "thrust = 0.05"), "0.05 of the thrust is not more than the weight"},
      {course(ball, "thrust = 0.05"), "to hover: give more than that"},
      {refused("gates = {}, start = {0, 0, 1}, finish = {3, 0, 1}"), "needs gates"},
      {refused("gates = { 7 }"), "gates[1]"},
      {refused("gates = { " + ball + " }, start = 5"), "start"},
      {course("{ shape = 'ball', position = {50000, 0, 2}, radius = 0.5 }"), "battery"},
      {refused("gates = {}"), "needs gates"},
      {refused("gates = { " + ball + " }, closed = true, start = {0, 0, 1}"),
       "neither start nor finish"},
      {refused("input = 'nowhere.yaml'"), "nowhere.yaml"},
  };
  for (const auto& [message, part] : cases)
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

}  // namespace
}  // namespace lapwing
