// SPDX-License-Identifier: Apache-2.0
// The shipped films with a camera, end to end: certified, and the subject in the image.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

TEST_F(Filming, EveryShippedFilmIsCertified) {
  for (const char* film : kCameraFilms) {
    SCOPED_TRACE(film);
    const Flown flown = fly(film);
    expect_certified(flown);
    EXPECT_EQ(flown.result.at("solver").at("status").as_text(), "optimal");
    EXPECT_GE(framing(flown), 0.99);
  }
}

TEST_F(Filming, IpoptFindsTheSameFilms) {
  for (const char* film : {"two_actors.lua", "follow_walker.lua"}) {
    SCOPED_TRACE(film);
    const Flown iqp = fly(film, "", "iqp"), ipopt = fly(film, "--config solvers/ipopt", "ipopt");
    expect_certified(ipopt);
    EXPECT_GE(framing(ipopt), 0.99);
    EXPECT_NEAR(cost(ipopt), cost(iqp), 0.01 * cost(iqp));
  }
}

TEST_F(Filming, StylesByConfiguration) {
  for (const char* style : {"smooth", "precise", "dramatic"}) {
    SCOPED_TRACE(style);
    const Flown flown = fly("castle_flyover.lua", std::string("--config filming/") + style, style);
    expect_certified(flown);
    EXPECT_GE(framing(flown), 0.99);
  }
  const auto unweighted = [](const Flown& flown, const char* term, double weight) {
    return flown.result.at("solver").at("terms").at(term).as_number() / weight;
  };
  const Flown smooth = fly("castle_flyover.lua", "--config filming/smooth", "smooth");
  const Flown precise = fly("castle_flyover.lua", "--config filming/precise", "precise");
  EXPECT_LT(unweighted(smooth, "gimbal_derivative", 1),
            unweighted(precise, "gimbal_derivative", 0.01));
  EXPECT_GT(unweighted(smooth, "camera_angle", 50), unweighted(precise, "camera_angle", 1000));
}

TEST_F(Filming, AMovedKeyframeChangesTheFilm) {
  const Flown moved = fly("castle_flyover.lua", "--set 'keyframes[2].position=[0, -2, 15]'");
  expect_certified(moved);
  const Plan plan = read_plan(moved.folder / "plan.json");
  double top = 0;
  for (const Sample& s : plan.trajectory.samples) top = std::max(top, s.position.z());
  EXPECT_NEAR(top, 15, 0.3);
}

class SlowFilming : public Filming {};

// A way that obstacles close: an honest answer with the obstacle and the time.
TEST_F(SlowFilming, AClosedWayIsReported) {
  write_file_atomically(folder_ / "closed.lua", R"(return require "mission.film".shot {
    name = "closed", duration = 12, hard = 0.5,
    keyframes = { { time = 0, position = {-10, 0, 3} }, { time = 12, position = {10, 0, 3} } },
    obstacles = {
      { type = "box", name = "left wall", lower = {-1, -200, -50}, upper = {1, 0.2, 200} },
      { type = "box", name = "right wall", lower = {-1, -0.2, -50}, upper = {1, 200, 200} } } })");
  const Flown flown = fly((folder_ / "closed.lua").string(), "--set stretch=1");
  EXPECT_EQ(flown.status, 1);
  bool clearance = false;
  const Plan plan = read_plan(flown.folder / "plan.json");
  for (const Check& check : verify(plan).failures()) {
    if (check.name != "clearance") continue;
    clearance = true;
    EXPECT_GT(check.at, 0);
    EXPECT_LT(check.at, 12);
  }
  EXPECT_TRUE(clearance) << to_json(flown.result);
}

// A camera below its subject, on a gimbal that looks down only.
TEST_F(Filming, AGimbalThatCannotSeeIsReported) {
  write_file_atomically(folder_ / "below.lua", R"(return require "mission.film".shot {
    name = "below", duration = 6, subject = { position = {0, 0, 40}, height = 2 },
    keyframes = { { time = 0, position = {-10, 0, 3} }, { time = 6, position = {-6, 4, 3} } } })");
  const Flown flown = fly((folder_ / "below.lua").string());
  EXPECT_EQ(flown.status, 1);
  EXPECT_EQ(flown.result.at("status").as_text(), "not_certified");
  EXPECT_LT(framing(flown), 0.5);
  const std::string note = flown.result.at("notes").as_list().at(0).as_text();
  EXPECT_NE(note.find("gimbal_pitch"), std::string::npos) << note;
}

// The straight way leads through the middle of a zone without floor or ceiling: what solvers begin
// with goes round it.
TEST_F(Filming, AWayRoundIsPlannedToBeginWith) {
  write_file_atomically(folder_ / "round.lua", R"(return require "mission.film".shot {
    name = "round", duration = 8, vehicle = "vehicles/solo",
    subject = { position = {0, -6, 1}, height = 2 },
    keyframes = { { time = 0, position = {-6, -6, 3} }, { time = 8, position = {6, -6, 4} } },
    obstacles = { { type = "no_fly_zone", corners = {{-2,-8},{2,-8},{2,-4},{-2,-4}} } } })");
  for (const char* planner : {"bit_star", "rrt_connect", "rrt_star"})
    expect_certified(fly((folder_ / "round.lua").string(),
                         std::string("--set planner.iterations=2000 --set planner.type=") + planner,
                         planner));
}

TEST_F(Filming, ThroughTheForestBetweenSixtyTrunks) {
  expect_certified(fly("through_the_forest.lua", "--set solver.iterations=12"));
}

}  // namespace
}  // namespace lapwing
