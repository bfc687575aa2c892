// SPDX-License-Identifier: Apache-2.0
// Films whose path is kept and whose times are found.
#include "tests/missions/flown_film.h"
#include "tests/missions/random_list.h"

namespace lapwing {
namespace {

class TimedFilms : public Filming {
 protected:
  static std::string film(const std::string& second = "", const std::string& more = "") {
    return R"(return require "mission.film".shot {
      name = "timed", vehicle = "vehicles/solo", timing = "path_first",
      keyframes = { { position = {0, 0, 3} }, { position = {14, 2, 5})" +
           second + R"( }, { position = {20, 14, 4} } }, )" + more + "}";
  }
  Flown timed(const std::string& text, const std::string& more = "", const char* name = "out") {
    write_file_atomically(folder_ / "film.lua", text);
    return fly((folder_ / "film.lua").string(), more, name);
  }
  static double second_time(const Flown& flown) {
    return read_plan(flown.folder / "plan.json").task.keyframes.at(1).time;
  }
};

TEST_F(TimedFilms, AreFasterOnTheSamePath) {
  const Flown own = timed(film(), "--set timing=given", "own");
  const Flown fast = timed(film(), "", "fast");
  ASSERT_EQ(own.status, 0);
  ASSERT_EQ(fast.status, 0) << to_json(fast.result);
  const Plan slow_plan = read_plan(own.folder / "plan.json");
  const Plan fast_plan = read_plan(fast.folder / "plan.json");
  EXPECT_LT(fast_plan.trajectory.duration(), 0.75 * slow_plan.trajectory.duration());
  Points path;
  for (const Sample& s : slow_plan.trajectory.samples) path.push_back(s.position);
  for (const Sample& s : fast_plan.trajectory.samples)
    EXPECT_LT(distance_to({path}, s.position), 0.26) << s.time;
  EXPECT_LE(fast.result.at("film").at("path_error").as_number(), 0.25);
}

TEST_F(TimedFilms, WishesAreGranted) {
  const Flown free = timed(film());
  ASSERT_EQ(free.status, 0) << to_json(free.result);
  const double fastest = second_time(free);
  const auto asked = [&](const std::string& wish) {
    const Flown flown = timed(film(wish));
    EXPECT_EQ(flown.status, 0) << wish << to_json(flown.result);
    return second_time(flown);
  };
  EXPECT_NEAR(asked(", time = 9"), 9, 1e-9);
  const double window = asked(", earliest = 8, latest = 12");
  EXPECT_NEAR(window, 8, 0.06);
  EXPECT_NEAR(asked(", latest = 30"), fastest, 0.1) << "a window that asks for nothing";
  const double preferred = asked(", time = 9, time_weight = 0.2");
  EXPECT_GT(preferred, fastest + 0.1);
  EXPECT_LT(preferred, 9);
  EXPECT_GT(asked(", time = 9, time_weight = 50"), preferred);
}

// Times that are found together with the path.
class FreeFilms : public Filming {
 protected:
  Flown timed(const std::string& second, const std::string& third = "",
              const std::string& more = "", const std::string& flags = "", int worst = 1) {
    write_file_atomically(folder_ / "film.lua", R"(return require "mission.film".shot {
      name = "timed", vehicle = "vehicles/solo", timing = "free",
      keyframes = { { position = {0, 0, 3} }, { position = {14, 2, 5})" +
                                                    second + R"( }, { position = {20, 14, 4})" +
                                                    third + " } }, " + more + "}");
    return fly((folder_ / "film.lua").string(), flags, "out", worst);
  }
  // The times of the keyframes of a film that is certified.
  std::vector<double> times(const std::string& second, const std::string& third = "",
                            const std::string& more = "", const std::string& flags = "") {
    const Flown flown = timed(second, third, more, flags);
    EXPECT_EQ(flown.status, 0) << second << third << more << to_json(flown.result);
    std::vector<double> found;
    if (flown.status != 0) return {0, 0, 0};
    for (const auto& k : read_plan(flown.folder / "plan.json").task.keyframes)
      found.push_back(k.time);
    return found;
  }
};

TEST_F(FreeFilms, WishesAreGranted) {
  const std::vector<double> fastest = times("");
  EXPECT_NEAR(times(", time = 9")[1], 9, 1e-9);
  EXPECT_NEAR(times(", earliest = 8, latest = 12")[1], 8, 1e-3);
  EXPECT_NEAR(times(", latest = 3")[1], 3, 1e-3);
  EXPECT_NEAR(times(", latest = 30")[1], fastest[1], 0.02) << "a window that asks for nothing";
  EXPECT_NEAR(times("", ", earliest = 10, latest = 11")[2], 10, 1e-3) << "of the duration";
  EXPECT_NEAR(times("", "", "duration = 20,")[2], 20, 1e-9);
  const double preferred = times(", time = 9, time_weight = 0.2")[1];
  EXPECT_GT(preferred, fastest[1] + 1);
  EXPECT_LT(preferred, 8);
  EXPECT_NEAR(times(", time = 9, time_weight = 50")[1], 9, 0.05);
}

TEST_F(FreeFilms, SolversAgree) {
  EXPECT_NEAR(times("")[2], times("", "", "", "--set solver=ipopt")[2], 0.01);
}

TEST_F(FreeFilms, ADashTakesWhatTheAccelerationAllows) {
  write_file_atomically(folder_ / "film.lua", R"(return require "mission.film".shot {
    name = "dash", vehicle = "vehicles/solo", timing = "free", hard = 0.05,
    weights = { smoothness = 0, effort = 0, yaw = 0, time = 100 },
    keyframes = { { position = {0, 0, 3} }, { position = {14, 0, 3} } } })");
  const Flown flown = fly((folder_ / "film.lua").string(), "", "out");
  ASSERT_EQ(flown.status, 0) << to_json(flown.result);
  const double duration = read_plan(flown.folder / "plan.json").trajectory.duration();
  // From rest to rest over 13.9 m with 4 m/s^2, both ways: 2 sqrt(d / a).
  EXPECT_GT(duration, 3.72);
  EXPECT_LT(duration, 4.1);
}

// Positions in a box of 20 m, from seeds.
TEST_F(FreeFilms, RandomListsAreFlown) {
  for (const auto& [count, seed] : {std::pair{11, 1}, {11, 2}, {11, 3}, {11, 4}, {20, 5}}) {
    write_file_atomically(folder_ / "film.lua", random_list(count, seed));
    const Flown flown = fly((folder_ / "film.lua").string(), "", "out", 2);
    EXPECT_EQ(flown.status, 0) << count << " keyframes, seed " << seed << to_json(flown.result);
    EXPECT_EQ(flown.result.at("solver").at("status").as_text(), "optimal") << seed;
  }
}

// A solver that comes to no end is no fault of the script: the film is flown at other times.
TEST_F(FreeFilms, WhereNoTimesAreFoundThoseOfStraightFlightAreFlown) {
  write_file_atomically(folder_ / "film.lua", random_list(11, 1));
  const std::string film = (folder_ / "film.lua").string();
  const Flown best = fly(film, "", "out");
  const Flown flown = fly(film, "--set solver.steps=3", "out", 2);
  ASSERT_EQ(flown.status, 0) << to_json(flown.result);
  const std::string notes = to_json(flown.result.at("notes"));
  EXPECT_NE(notes.find("found no times of its own (iteration_limit)"), std::string::npos) << notes;
  EXPECT_NE(notes.find("straight flight"), std::string::npos) << notes;
  EXPECT_GT(flown.result.at("film").at("duration").as_number(),
            best.result.at("film").at("duration").as_number());
  // Times that are asked for are granted there too.
  EXPECT_NEAR(times(", time = 9", "", "", "--set solver.steps=3")[1], 9, 1e-9);
}

TEST_F(FreeFilms, WhatCannotBeGrantedIsNamed) {
  const Flown early = timed(", latest = 1.5", "", "", "", 2);
  EXPECT_EQ(early.status, 2);
  // 13.1 m from rest at 4 m/s^2, 0.1 s early and late.
  EXPECT_NE(to_json(early.result)
                .find("keyframes[2]: no times meet every wish: vehicle "
                      "'vehicles/solo' takes at least 2.339 s from keyframe 1"),
            std::string::npos)
      << to_json(early.result);
  const Flown fixed = timed("", "", "stretch = 2,", "", 2);
  EXPECT_EQ(fixed.status, 2);
  EXPECT_NE(to_json(fixed.result).find("finds the times itself"), std::string::npos);
}

// A time that only a late flight would keep: the film is no promise, and it is told how late.
TEST_F(FreeFilms, TimesThatAreSlightlyTooEarlyAreToldWithWhatWouldDo) {
  const Flown flown = timed(", time = 2.4");
  EXPECT_EQ(flown.status, 1);
  const std::string notes = to_json(flown.result.at("notes"));
  EXPECT_NE(notes.find("takes at least 2.539 s from keyframe 1 to 2"), std::string::npos) << notes;
  EXPECT_NE(notes.find("certified if all times are multiplied by 1.25"), std::string::npos)
      << notes;
  EXPECT_EQ(flown.result.at("film").at("certified_stretch").as_number(), 1.25);
  EXPECT_EQ(read_plan(flown.folder / "plan.json").task.keyframes.at(1).time, 2.4);
}

// Times that are found together with the camera and the terms of the script.
class FilmsAndTimes : public Filming {
 protected:
  Flown flown(const std::string& rest, const std::string& flags = "", int worst = 0) {
    write_file_atomically(folder_ / "film.lua", R"(return require "mission.film".shot {
      name = "together", vehicle = "vehicles/solo", timing = "free", )" +
                                                    rest + "}");
    return fly((folder_ / "film.lua").string(), flags, "out", worst);
  }
  static double figure(const Flown& film, const char* name) {
    return film.result.at("film").at(name).as_number();
  }
  static std::string notes(const Flown& film) { return to_json(film.result); }
};

constexpr const char* kWalked = R"(  step = 0.2,
  subject = { height = 1.8, size = 0.2, track = { { time = 0, position = {4, 8, 1} },
                                                  { time = 60, position = {64, 8, 1} } } },
  keyframes = { { position = {0, 0, 3} }, { position = {9, 1, 3})";

// While it hovers, the film costs 1 + 0.01 t^2 a second, and w (T - 20)^2 for its end T: the least
// is where 1 + 0.01 T^2 = 2 w (20 - T). Without the term of the script that is 20 - 1 / (2 w).
TEST_F(FilmsAndTimes, TheBestTimeIsThatOfTheWholeCost) {
  const double w = 0.5, best = (-2 * w + std::sqrt(4 * w * w + 0.04 * (40 * w - 1))) / 0.02;
  const Flown film = flown(R"(weights = { smoothness = 0, effort = 0, time = 1 },
    costs = { { name = "late", weight = 0.01, residual = function(s) return s.time end } },
    keyframes = { { position = {0, 0, 3} },
                  { position = {0, 0, 3}, time = 20, time_weight = 0.5 } })");
  ASSERT_EQ(film.status, 0) << to_json(film.result);
  // The sum over stages counts the last one too: half a step of 0.2 s in 16.
  EXPECT_NEAR(figure(film, "duration"), best, 0.05) << best;
  const auto cost = [&](double t) { return t + 0.01 * t * t * t / 3 + w * (t - 20) * (t - 20); };
  EXPECT_NEAR(figure(film, "cost_apart"), cost(19), 0.3);
  EXPECT_NEAR(figure(film, "cost_together"), cost(best), 0.3);
}

TEST_F(FilmsAndTimes, AWindowIsUsedFromItsBeginning) {
  const std::string open = std::string(kWalked) + " }, { position = {20, 2, 3} } }";
  const Flown free = flown(open);
  ASSERT_EQ(free.status, 0) << to_json(free.result);
  EXPECT_LT(figure(free, "cost_together"), 0.99 * figure(free, "cost_apart")) << "the camera waits";
  const double found = read_plan(free.folder / "plan.json").task.keyframes.at(1).time;
  // A window that begins after the best time is used from its beginning.
  const std::string earliest = std::to_string(found + 1);
  const Flown held =
      flown(std::string(kWalked) + ", earliest = " + earliest + "}, { position = {20, 2, 3} } }");
  ASSERT_EQ(held.status, 0) << to_json(held.result);
  EXPECT_NEAR(read_plan(held.folder / "plan.json").task.keyframes.at(1).time, found + 1, 1e-3);
  // Its cost is not less, but for the sums over other stages.
  EXPECT_GE(figure(held, "cost_together"), 0.99 * figure(free, "cost_together"));
  EXPECT_LE(figure(held, "cost_together"), figure(held, "cost_apart"));
}

TEST_F(FilmsAndTimes, APathIsKeptAtTimesThatTheCameraLikes) {
  const Flown film =
      flown(std::string(kWalked) + " }, { position = {20, 2, 3} } }", "--set timing=path_first");
  ASSERT_EQ(film.status, 0) << to_json(film.result);
  EXPECT_LT(figure(film, "cost_together"), 0.9 * figure(film, "cost_apart"));
  EXPECT_LE(figure(film, "path_error"), 0.25);
}

TEST_F(FilmsAndTimes, ASolveThatComesToNoEndLeavesTheTimesAsTheyWere) {
  const std::string film = std::string(kWalked) + " }, { position = {20, 2, 3} } }";
  const Flown stopped = flown(film, "--set solver.steps=18");
  ASSERT_EQ(stopped.status, 0) << to_json(stopped.result);
  EXPECT_NE(notes(stopped).find("the times are those found without the camera: the solver of both "
                                "together ended with iteration_limit"),
            std::string::npos)
      << notes(stopped);
  const Flown in_parts = flown(film, "--set horizon=5");
  EXPECT_NE(notes(in_parts).find("the film is solved in parts"), std::string::npos);
}

TEST_F(FilmsAndTimes, ASolverWithoutFreeTimesSaysWhy) {
  const Flown refused = flown(std::string(kWalked) + "} }", "--set solver=nlopt", 2);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(notes(refused).find("nlopt does not support free steps: its scaling"),
            std::string::npos)
      << notes(refused);
}

}  // namespace
}  // namespace lapwing
