// SPDX-License-Identifier: Apache-2.0
// Films that are solved in parts, and films of subjects whose tracks are not known in advance.
#include "tests/missions/flown_film.h"
#include "tests/missions/random_list.h"

namespace lapwing {
namespace {

class HorizonFilms : public Filming {
 protected:
  Flown film(const std::string& text, const std::string& more = "", const char* name = "out",
             int worst = 1) {
    write_file_atomically(folder_ / "film.lua", text);
    return fly((folder_ / "film.lua").string(), more, name, worst);
  }
  std::string refusal(const std::string& text) {
    EXPECT_EQ(film(text, "", "refused", 2).status, 2);
    return read_file(folder_ / "stderr.txt");
  }
};

TEST_F(HorizonFilms, CostWithinOnePercentOfTheWhole) {
  const std::string text = long_walk(10, 1);
  const Flown whole = film(text), parts = film(text, "--set horizon=6");
  ASSERT_EQ(whole.status, 0);
  expect_certified(parts);
  EXPECT_GT(cost(parts), 0.9999 * cost(whole)) << "the whole is not optimal";
  EXPECT_LT(cost(parts), 1.01 * cost(whole));
  const std::string log = read_file(parts.folder / "run.log");
  EXPECT_GT(std::count(log.begin(), log.end(), '\n'), 5) << "one line for each part";
}

// Long beyond the film: one part, which is the whole film.
TEST_F(HorizonFilms, OnePartIsTheWhole) {
  const std::string text = long_walk(4, 5);
  const Flown whole = film(text, "", "whole"), one = film(text, "--set horizon=100", "one");
  EXPECT_EQ(cost(one), cost(whole));
  const Plan a = read_plan(whole.folder / "plan.json"), b = read_plan(one.folder / "plan.json");
  ASSERT_EQ(a.trajectory.samples.size(), b.trajectory.samples.size());
  for (std::size_t i = 0; i < a.trajectory.samples.size(); ++i)
    EXPECT_EQ(a.trajectory.samples[i].position, b.trajectory.samples[i].position) << i;
}

TEST_F(HorizonFilms, GoAroundObstaclesWithinSpeedLimitsAndCuts) {
  const Flown flown = film(R"(return require "mission.film".shot {
    name = "around", speed_limit = 4, hard = 0.3, horizon = 4, finish = "free",
    subjects = { { name = "a", position = {20, 10, 1} }, { name = "b", position = {50, -12, 1} } },
    keyframes = {
      { time = 0, position = {0, 0, 3}, look_at = "a" },
      { time = 8, position = {20, 0, 3}, look_at = "a" },
      { time = 18, position = {40, 2, 4}, look_at = "b" },
      { time = 28, position = {60, 0, 3}, look_at = "b" } },
    cuts = { { start = 9, finish = 11 } },
    obstacles = { { type = "sphere", name = "ball", center = {30, 1, 3}, radius = 2 },
                  { type = "box", name = "wall", lower = {48, -2, 0}, upper = {49, 2, 8} } } })");
  expect_certified(flown);
}

// A subject that turns at 3 s one way or the other.
std::string forked(const std::string& turn, const std::string& more = "") {
  return R"(return require "mission.film".shot {
    name = "fork", start = "moving", start_velocity = {2, 0, 0}, finish = "free",
    subject = { name = "walker", live = true, height = 1.8, )" +
         more +
         R"( track = { { time = 0, position = {0, 0, 1} }, { time = 3, position = {6, 0, 1} },
                { time = 7, position = {10, )" +
         turn + R"(, 1} } } },
    keyframes = { { time = 0, beside = "walker", position = {-5, -4, 2} },
                  { time = 3, beside = "walker", position = {-5, -4, 2} },
                  { time = 7, beside = "walker", position = {-5, -4, 2} } } })";
}

// A planner that knew the future would fly otherwise before the fork.
TEST_F(HorizonFilms, NoPlanKnowsTheFutureOfALiveSubject) {
  const Flown left = film(forked("6"), "", "left"), right = film(forked("-6"), "", "right");
  expect_certified(left);
  expect_certified(right);
  const Plan a = read_plan(left.folder / "plan.json"), b = read_plan(right.folder / "plan.json");
  ASSERT_EQ(a.trajectory.samples.size(), b.trajectory.samples.size());
  double apart = 0;
  for (std::size_t i = 0; i < a.trajectory.samples.size(); ++i) {
    const Sample &one = a.trajectory.samples[i], &other = b.trajectory.samples[i];
    const double distance = (one.position - other.position).norm();
    if (one.time <= 3) {
      EXPECT_EQ(distance, 0) << one.time;
      EXPECT_EQ(one.target, other.target) << one.time;
    }
    apart = std::max(apart, distance);
  }
  EXPECT_GT(apart, 2) << "it follows either way";
}

class SlowHorizonFilms : public HorizonFilms {};

TEST_F(SlowHorizonFilms, ASubjectThatIsSeenLateIsFollowedLater) {
  const auto turns_at = [&](const std::string& delay, const char* name) {
    const Plan a =
        read_plan(film(forked("6", "delay = " + delay + ","), "", name).folder / "plan.json");
    const Plan b =
        read_plan(film(forked("-6", "delay = " + delay + ","), "", name).folder / "plan.json");
    for (std::size_t i = 0; i < a.trajectory.samples.size(); ++i)
      if (a.trajectory.samples[i].target != b.trajectory.samples[i].target)
        return a.trajectory.samples[i].time;
    return 0.0;
  };
  const double at_once = turns_at("0", "once"), late = turns_at("0.5", "late");
  EXPECT_NEAR(at_once, 3.1, 0.11);
  EXPECT_NEAR(late - at_once, 0.5, 0.11);
}

// Beside a subject whose track is known, a place is promised like any other.
TEST_F(HorizonFilms, PlacesBesideAKnownSubjectAreKept) {
  const Flown flown = film(R"(return require "mission.film".shot {
    name = "beside", subject = { height = 1.8, track = { { time = 0, position = {0, 0, 1} },
                                                         { time = 10, position = {10, 4, 1} } } },
    keyframes = { { time = 0, beside = "subject", position = {0, -6, 2} },
                  { time = 5, beside = "subject", position = {-6, 0, 2} },
                  { time = 10, beside = "subject", position = {0, 6, 2} } } })");
  expect_certified(flown);
  const Plan plan = read_plan(flown.folder / "plan.json");
  ASSERT_EQ(plan.task.keyframes.size(), 3u);
  EXPECT_LT((plan.task.keyframes[1].position - Eigen::Vector3d(-1, 2, 3)).norm(), 1e-12);
}

TEST_F(HorizonFilms, WhatALiveSubjectCannotHaveIsSaid) {
  const auto live = [&](const std::string& subject, const std::string& keyframe,
                        const std::string& more) {
    return refusal("return require 'mission.film'.shot { name = 'wrong', subject = { name = 'a', " +
                   subject + " }, keyframes = { { time = 0, position = {0, 0, 2} }, { " + keyframe +
                   "position = {9, 0, 2} } }, " + more + " }");
  };
  const std::string track =
      "track = { { time = 0, position = {0, 5, 1} }, { time = 9, position = {9, 5, 1} } }";
  const std::string moving = "live = true, " + track;
  EXPECT_NE(live("live = true, position = {0, 5, 1}", "time = 9, ", "")
                .find("subjects[1].live: a subject with a position stands still; give a track"),
            std::string::npos);
  EXPECT_NE(live("delay = 1, " + track, "time = 9, ", "").find("only a live subject is seen late"),
            std::string::npos);
  EXPECT_NE(live(moving, "", "timing = 'free'").find("timing: a live subject does not wait"),
            std::string::npos);
  EXPECT_NE(
      live(moving, "time = 9, ", "stretch = 'auto'").find("stretch: a live subject does not wait"),
      std::string::npos);
  EXPECT_NE(live(moving, "time = 9, beside = 'b', ", "")
                .find("keyframes[2].beside: no subject is named 'b'"),
            std::string::npos);
  EXPECT_NE(live(moving, "beside = 'a', ", "")
                .find("keyframes[2].time: a keyframe beside a subject needs a time"),
            std::string::npos);
}

}  // namespace
}  // namespace lapwing
