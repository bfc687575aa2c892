// SPDX-License-Identifier: Apache-2.0
// Films with a camera: what scripts may say, and what is refused.
#include "tests/mission/mission_fixture.h"
#include "tests/obstacles.h"

namespace lapwing {
namespace {

class FilmTest : public MissionTest {
 protected:
  // A shot of 8 s past the origin, with more of its table.
  static std::string shot(const std::string& more, const std::string& looks = "") {
    return "return require('mission.film').shot { duration = 8, " + more +
           " keyframes = { { time = 0, position = {-6, -6, 3} }, "
           "{ time = 8, position = {6, -6, 4}" +
           looks + " } } }";
  }
  Plan plan(const std::string& text, std::vector<std::string> overrides = {}) {
    const auto mission = load(text);
    mission->configure({}, overrides);
    return mission->plan().plan;
  }
};

TEST_F(FilmTest, TheCameraStaysOnItsSubject) {
  const Plan film = plan(shot("subject = { position = {0, 0, 1}, height = 2 },"));
  EXPECT_TRUE(film.trajectory.has_gimbal);
  EXPECT_TRUE(film.trajectory.has_target);
  ASSERT_EQ(film.environment.subjects.size(), 1u);
  EXPECT_EQ(film.environment.subjects[0].name, "subject");
  EXPECT_EQ(film.environment.subjects[0].height, 2);
  ASSERT_EQ(film.task.framing.size(), 1u);
  EXPECT_EQ(film.task.framing[0].span.start, 0);
  EXPECT_EQ(film.task.framing[0].span.finish, 8);
  for (const Sample& s : film.trajectory.samples) {
    const Eigen::Vector3d d = Eigen::Vector3d(0, 0, 1) - s.position;
    EXPECT_NEAR(s.gimbal_pitch, std::atan2(d.z(), d.head<2>().norm()), 0.05) << s.time;
    EXPECT_NEAR(std::remainder(s.yaw + s.gimbal_yaw - std::atan2(d.y(), d.x()), 2 * M_PI), 0, 0.05)
        << s.time;
  }
}

TEST_F(FilmTest, FromOneSubjectToAnother) {
  const Plan film = plan(
      "return require('mission.film').shot { duration = 12, subjects = { "
      "{ name = 'a', position = {-3, 0, 1} }, { name = 'b', position = {3, 0, 1} } }, "
      "keyframes = { { time = 0, position = {-3, -8, 3}, look_at = 'a' }, "
      "{ time = 4, position = {-2, -8, 3} }, { time = 8, position = {2, -8, 3}, look_at = 'b' }, "
      "{ time = 12, position = {3, -8, 3} } } }");
  ASSERT_EQ(film.task.framing.size(), 2u);
  EXPECT_EQ(film.task.framing[0].subject, "a");
  EXPECT_NEAR(film.task.framing[0].span.finish, 5, 1e-9) << "half of the leg to go over";
  EXPECT_NEAR(film.task.framing[1].span.start, 7, 1e-9);
  const auto target = [&](double time) {
    for (const Sample& s : film.trajectory.samples)
      if (s.time > time - 1e-6) return s.target;
    return Eigen::Vector3d(1e9, 0, 0);
  };
  EXPECT_LT((target(2) - Eigen::Vector3d(-3, 0, 1)).norm(), 0.2);
  EXPECT_NEAR(target(6).x(), 0, 0.3) << "half-way at half-time";
  EXPECT_LT((target(10) - Eigen::Vector3d(3, 0, 1)).norm(), 0.2);
}

TEST_F(FilmTest, TracksAreListsOrFunctions) {
  const std::string list =
      "subject = { track = { { time = 0, position = {0, 0, 1} }, { time = 8, position = {4, 0, 1} "
      "} "
      "} },";
  const std::string function = "subject = { track = function(t) return {t / 2, 0, 1} end },";
  const Plan a = plan(shot(list)), b = plan(shot(function));
  EXPECT_EQ(b.environment.subjects[0].times.size(), 81u) << "every tenth of a second";
  for (const double t : {0.0, 3.3, 8.0})
    EXPECT_LT(
        (a.environment.subjects[0].position(t) - b.environment.subjects[0].position(t)).norm(),
        1e-9);
}

TEST_F(FilmTest, StretchedFilmsStretchTracksAndCuts) {
  const Plan film =
      plan(shot("stretch = 2, cuts = { { start = 3, finish = 4 } }, "
                "subject = { track = { { time = 0, position = {0, 0, 1} }, "
                "{ time = 8, position = {4, 0, 1} } } },"));
  EXPECT_EQ(film.environment.subjects[0].times.back(), 16);
  ASSERT_EQ(film.cuts.size(), 1u);
  EXPECT_EQ(film.cuts[0].start, 6);
  EXPECT_EQ(film.cuts[0].finish, 8);
}

TEST_F(FilmTest, ACutLastsAsLongAsTheCameraNeeds) {
  const Plan film = plan(
      "return require('mission.film').shot { duration = 12, subjects = { "
      "{ name = 'a', position = {0, 9, 2} }, { name = 'b', position = {0, -9, 2} } }, "
      "cuts = { { start = 6 } }, keyframes = { "
      "{ time = 0, position = {-2, 0, 2}, look_at = 'a' }, "
      "{ time = 12, position = {2, 0, 2}, look_at = 'b' } } }");
  ASSERT_EQ(film.cuts.size(), 1u);
  EXPECT_GE(film.cuts[0].finish, 6.2);
  EXPECT_LT(film.cuts[0].finish, 9);
}

// Looks two seconds apart, back and forth: each is framed, half of the time is left for turning.
TEST_F(FilmTest, ShortLegsAreFramedToo) {
  std::string keyframes;
  for (int i = 0; i < 5; ++i)
    keyframes += "{ time = " + std::to_string(2 * i) + ", position = {" + std::to_string(i) +
                 ", -9, 3}, look_at = '" + (i % 2 ? "b" : "a") + "' }, ";
  const Plan film = plan(
      "return require('mission.film').shot { subjects = { { name = 'a', position = {-1, 0, 1} }, "
      "{ name = 'b', position = {4, 0, 1} } }, keyframes = {" +
      keyframes + "} }");
  ASSERT_EQ(film.task.framing.size(), 5u);
  double asked = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const FramingTask& framing = film.task.framing[i];
    EXPECT_EQ(framing.subject, i % 2 ? "b" : "a");
    EXPECT_LE(framing.span.start, 2.0 * i);
    EXPECT_GE(framing.span.finish, 2.0 * i);
    asked += framing.span.finish - framing.span.start;
  }
  EXPECT_NEAR(asked, 4, 1e-9);
}

// A cut between two subjects: the one is framed up to it, the other from its end on.
TEST_F(FilmTest, ACutChangesTheSubject) {
  const Plan film = plan(
      "return require('mission.film').shot { duration = 12, subjects = { "
      "{ name = 'a', position = {-3, 0, 1} }, { name = 'b', position = {3, 0, 1} } }, "
      "cuts = { { start = 2, finish = 4 } }, keyframes = { "
      "{ time = 0, position = {-3, -8, 3}, look_at = 'a' }, "
      "{ time = 12, position = {3, -8, 3}, look_at = 'b' } } }");
  ASSERT_EQ(film.task.framing.size(), 2u);
  EXPECT_EQ(film.task.framing[0].span.finish, 2);
  EXPECT_EQ(film.task.framing[1].span.start, 4);
  EXPECT_TRUE(verify(film).feasible());
  for (const Sample& s : film.trajectory.samples) {
    if (s.time > 2 && s.time < 4) continue;
    const Eigen::Vector3d d = Eigen::Vector3d(s.time < 3 ? -3 : 3, 0, 1) - s.position;
    EXPECT_NEAR(std::remainder(s.yaw + s.gimbal_yaw - std::atan2(d.y(), d.x()), 2 * M_PI), 0, 0.1)
        << s.time;
  }
}

TEST_F(FilmTest, WhatTheVehicleCannotFilmIsRefused) {
  expect(shot("vehicle = 'vehicles/racer', subject = { position = {0, 0, 1} },"),
         "subjects[1]: vehicle 'vehicles/racer' has no gimbal");
  expect(shot("vehicle = 'vehicles/racer',", ", look_at = {0, 0, 1}"),
         "keyframes[2].look_at: vehicle 'vehicles/racer' has no gimbal");
  expect(shot("subject = { position = {5, -6, 4}, distance = 6 },"),
         "keyframes[2].position: 1 m from subject 'subject', and 6 m are required");
  expect(shot("subject = { position = {0, 0, 1} }, cuts = { { start = 0, finish = 8 } },"),
         "cuts: no part of the subject is in the image");
  expect(shot("subject = { track = function(t) return {3 * math.sin(t * 20 * math.pi + 1), 0, 1} "
              "end },"),
         "between 0 and 0.1 s it is");
}

// A subject on ground that must not be flown over is filmed from outside it.
TEST_F(FilmTest, ASubjectInsideANoFlyZoneIsFilmedFromOutside) {
  const Plan film = plan(
      "return require('mission.film').shot { duration = 12, "
      "subject = { position = {0, 0, 1}, height = 2 }, obstacles = { { type = 'no_fly_zone', "
      "name = 'stage', corners = {{-4, -4}, {4, -4}, {4, 4}, {-4, 4}} } }, keyframes = { "
      "{ time = 0, position = {-10, -2, 4} }, { time = 12, position = {10, -2, 4} } } }");
  EXPECT_TRUE(verify(film).feasible());
  for (const Sample& s : film.trajectory.samples)
    EXPECT_GE(signed_distance(film.environment.obstacles[0], s.position), 0.5) << s.time;
}

TEST_F(FilmTest, WrongSubjectsAreNamed) {
  const auto subject = [&](const std::string& text) { return shot("subject = {" + text + "},"); };
  expect(subject("height = 2"), "subjects[1]: expected a position, or a track");
  expect(subject("position = {0, 0, 1}, track = { { time = 0, position = {0, 0, 1} } }"),
         "subjects[1]: expected a position, or a track");
  expect(subject("positon = {0, 0, 1}"), "did you mean 'position'?");
  expect(subject("position = {0, 0, 1}, height = -1"), "height: expected between 0");
  expect(
      subject("track = { { time = 0, position = {0, 0, 1} }, { time = 5, position = {1, 0, 1} } }"),
      "runs from 0 s to 5 s, but 'subject' is looked at from 0 s to 8 s");
  expect(
      subject("track = { { time = 3, position = {0, 0, 1} }, { time = 3, position = {1, 0, 1} } }"),
      "subjects[1].track[2].time: times must rise");
  expect(subject("track = { { time = 3 } }"), "subjects[1].track[1].position: missing");
  expect(subject("track = function(t) return t end"),
         "subjects[1].track: expected {x, y, z} at 0 s, got number");
  expect(subject("track = function(t) return nil + t end"), "arithmetic");
  expect(shot("subject = { position = {0, 0, 1} }, subjects = {},"), "subject or subjects");
  const std::string two =
      "subjects = { { name = 'a', position = {0, 0, 1} }, { name = 'b', position = {1, 0, 1} } },";
  expect(shot(two), "with several, keyframes select one: look_at = \"a\"");
  expect(shot(two, ", look_at = 'c'"), "keyframes[2].look_at: no subject is named 'c'");
  expect(shot("subjects = { { name = 'a', position = {0, 0, 1} }, "
              "{ name = 'a', position = {1, 0, 1} } },"),
         "subjects[2].name: 'a' is taken");
}

TEST_F(FilmTest, WrongCutsAreNamed) {
  const auto cut = [&](const std::string& text) {
    return shot("subject = { position = {0, 0, 1} }, cuts = {" + text + "},");
  };
  expect(cut("{ start = 5, finish = 5 }"), "cuts[1].finish: a cut ends after it starts");
  expect(cut("{ start = 5, finish = 9 }"), "cuts[1]: ends at 9 s, after the film's 8 s");
  expect(cut("{ start = 5, finish = 6 }, { start = 5.5, finish = 7 }"), "cuts[2].start");
  expect(cut("{ finish = 6 }"), "cuts[1].start: missing");
  expect(shot("cuts = { { start = 1, finish = 2 } },"), "cuts: a cut needs a subject");
}

TEST_F(FilmTest, WrongObstaclesAreNamed) {
  const auto obstacle = [&](const std::string& text) {
    return shot("obstacles = { {" + text + "} },");
  };
  expect(obstacle("type = 'sphere', center = {0, 0, 1}"), "obstacles[1].radius: missing");
  expect(obstacle("type = 'box', lower = {0, 0, 0}, upper = {1, 1, 1}, radius = 1"),
         "obstacles[1].radius: unknown key");
  expect(obstacle("type = 'box', lower = {0, 0, 0}, upper = {1, 0, 1}"),
         "lower must be below upper");
  expect(obstacle("type = 'cylnder'"), "unknown shape 'cylnder'");
  expect(obstacle("type = 'spere'"), "did you mean 'sphere'?");
  expect(obstacle("center = {0, 0, 1}"), "obstacles[1]: expected `type`");
  expect(obstacle("type = 'half_space', point = {0, 0, 0}, normal = {0, 0, 0}"),
         "normal: expected a vector that is not zero");
  expect(obstacle("type = 'sphere', center = {0, 0, 1}, radius = 1, side = 'beside'"),
         "obstacles[1].side");
  expect(obstacle("type = 'sphere', center = {0, 0, 9}, radius = 1, track = { { time = 1, "
                  "move = {0, 0, 0} }, { time = 1, move = {1, 0, 0} } }"),
         "track: times must rise");
  expect(obstacle("type = 'no_fly_zone', corners = {{0, 0}, {1, 0}}"), "at least three pairs");
  expect(obstacle("type = 'no_fly_zone', corners = {{0, 0}, {4, 4}, {4, 0}, {0, 4}}"),
         "its edges cross or touch");
  expect(
      obstacle("type = 'no_fly_zone', corners = {{0, 0}, {1, 0}, {0, 1}}, floor = 3, ceiling = 2"),
      "ceiling must be above");
  expect(obstacle("type = 'sphere', name = 'oak', center = {-6, -6, 3}, radius = 2"),
         "keyframes[1].position: inside obstacle 'oak': -2 m from its surface");
  expect(obstacle("type = 'box', lower = {5, -7, 0}, upper = {7, -5, 8}"),
         "keyframes[2].position: inside obstacle 'box 1'");
}

TEST_F(FilmTest, WrongFlightZonesAreNamed) {
  const auto zone = [&](const std::string& text) {
    return shot("flight_zones = { { name = 'yard', " + text + "} },");
  };
  expect(zone("corners = {{0, 0}, {1, 0}}"),
         "flight zone 'yard': corners: expected at least three");
  expect(zone("corners = {{0, 0}, {4, 4}, {4, 0}, {0, 4}}"),
         "flight zone 'yard': its edges cross or touch");
  expect(zone("corners = {{0, 0}, {1, 0}, {0, 1}}, floor = 3, ceiling = 2"),
         "flight zone 'yard': its ceiling must be above its floor");
  expect(zone("corners = {{-9, -9}, {5, -9}, {5, 9}, {-9, 9}}"),
         "keyframes[2].position: outside flight zone 'yard': 1 m beyond its edge");
  expect(zone("corners = {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, ceiling = 3.5"),
         "keyframes[2].position: outside flight zone 'yard': 0.5 m beyond its edge");
  expect(zone("corners = {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, top = 3"),
         "flight_zones[1].top: unknown key");
  expect(shot("volume = { lower = {-9, -9, 0} },"), "volume: expected lower and upper");
  expect(shot("volume = { lower = {-9, -9, 5}, upper = {9, 9, 0} },"),
         "volume: lower must be below upper");
  expect(shot("volume = { lower = {-9, -9, 0}, upper = {9, 9, 3.2} },"),
         "keyframes[2].position: outside flight zone 'volume'");
}

TEST_F(FilmTest, ABatteryThatIsTooSmallIsNamed) {
  expect(shot("battery = 6,"), "duration: 8 s of flight are more than the 6 s that `battery`");
  expect(shot("battery = 10, stretch = 2,"), "16 s of flight are more than the 10 s");
  const Plan film = plan(shot("battery = 60,"));
  EXPECT_EQ(film.budget, 60);
  EXPECT_TRUE(verify(film).find("budget")->pass);
  expect(
      "return require('mission.film').shot { keyframes = { { time = 0, position = {0, 0, 3} }, "
      "{ time = 5000, position = {1, 0, 3} } } }",
      "5000 s of flight are more than the 1200 s that vehicle '");
}

TEST_F(FilmTest, FilesOfObstaclesAreChecked) {
  const auto obstacle = [&](const std::string& text) {
    return shot("obstacles = { {" + text + "} },");
  };
  expect(obstacle("type = 'mesh'"), "obstacles[1].file: missing; expected a text");
  expect(obstacle("type = 'mesh', file = 'gone.ply'"), "gone.ply");
  expect(obstacle("type = 'mesh', file = '../wall.ply'"), "../wall.ply");
  expect(obstacle("type = 'sphere', center = {0, 0, 1}, radius = 1, file = 'a.ply'"),
         "obstacles[1].file: unknown key; known: type, name, side, opaque, track, center, radius");
  write_file_atomically(folder_ / "broken.ply", "ply\nno more");
  expect(obstacle("type = 'mesh', file = 'broken.ply'"), "broken.ply");
  write_file_atomically(folder_ / "broken.ot", "# Octomap OcTree file\nid OcTree\n");
  expect(obstacle("type = 'map', file = 'broken.ot'"), "broken.ot");
}

TEST_F(FilmTest, WishesForTimesMustMakeSense) {
  const auto timed = [](const std::string& second, const std::string& more = "") {
    return "return require('mission.film').shot { timing = 'path_first', " + more +
           " keyframes = { { position = {0, 0, 3} }, { position = {9, 0, 3}, " + second +
           " }, { position = {20, 5, 3} } } }";
  };
  expect(timed("time = 0.5"), "keyframes[2]: cannot be passed at its time: from the keyframe");
  expect(timed("latest = 1"), "keyframes[2]: cannot be passed at its time");
  expect(timed("earliest = 9, latest = 5"), "keyframes[2].latest: comes before earliest");
  expect(timed("time = 9, latest = 12"), "keyframes[2].time: give a time, or earliest and latest");
  expect(timed("time_weight = 1"), "keyframes[2].time_weight: needs a time");
  expect(timed("earliest = 9", "stretch = 2,"), "path_first finds the times itself");
  expect(shot("", ", time_weight = 1"), "need timing = \"path_first\"");
}

TEST_F(FilmTest, ShotTypesMakeKeyframes) {
  const auto keyframes = [&](const std::string& shots) {
    return plan(
               "local film = require 'mission.film'\nlocal shots = film.shots\n"
               "return film.shot { subject = { name = 's', position = {0, 0, 1} }, keyframes = " +
               shots + " }")
        .task.keyframes;
  };
  const auto orbit = keyframes(
      "shots.orbit { center = {0, 0, 1}, radius = 10, height = 4, angle = -90, from = 180, "
      "duration = 12 }");
  ASSERT_EQ(orbit.size(), 23u);
  EXPECT_LT((orbit.front().position - Eigen::Vector3d(-10, 0, 4)).norm(), 1e-9);
  EXPECT_LT((orbit.back().position - Eigen::Vector3d(0, 10, 4)).norm(), 1e-9);
  EXPECT_NEAR(orbit[11].time, 6, 1e-9);
  const auto joined = keyframes(
      "shots.sequence(shots.static { position = {5, 0, 2}, duration = 4 }, "
      "shots.crane { position = {5, 0, 2}, by = 3, duration = 6 }, "
      "shots.flyover { from_position = {5, 0, 5}, to_position = {-5, 0, 5}, height = 4, start = 2, "
      "duration = 10 })");
  EXPECT_NEAR(joined.back().time, 22, 1e-9);
  EXPECT_LT((joined[joined.size() - 2].position - Eigen::Vector3d(0, 0, 9)).norm(), 1e-9);
  const auto by_speed = keyframes(
      "shots.sequence({ { position = {0, 0, 2} }, { position = {8, 0, 2}, speed = 2 } }, "
      "{ { position = {8, 0, 2}, look_at = 's' }, { position = {8, 6, 2}, speed = 1 } })");
  ASSERT_EQ(by_speed.size(), 3u);
  EXPECT_LT((by_speed[1].position - Eigen::Vector3d(8, 0, 2)).norm(), 1e-12);
  EXPECT_GT(by_speed[1].time, 4);
  EXPECT_GT(by_speed[2].time - by_speed[1].time, 6);
  expect(
      "return require('mission.film').shots.sequence({ { time = 0, position = {0, 0, 2} }, "
      "{ time = 4, position = {8, 0, 2} } }, { { position = {8, 6, 2}, speed = 1 } })",
      "shots.sequence: keyframe 1 of list 2 has no time, but keyframe 2 of list 1 has one: give "
      "every keyframe a time, or none and a speed");
  expect("return require('mission.film').shots.orbit { radius = 3, duration = 4 }",
         "shots.orbit.center: missing");
  expect("return require('mission.film').shots.crane { position = {0, 0, 1}, by = 1, duraton = 4 }",
         "shots.crane.duraton: unknown key; did you mean 'duration'?");
  expect("return require('mission.film').shots.static { position = {0, 0, 1} }",
         "shots.static.duration: missing");
}

}  // namespace
}  // namespace lapwing
