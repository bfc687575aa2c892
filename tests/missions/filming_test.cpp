// SPDX-License-Identifier: Apache-2.0
// The shipped films end to end.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

TEST_F(Filming, HelloIsShort) {
  const std::string text = read_file(kExamples / "hello.lua");
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 15);
}

TEST_F(Filming, HelloIsCertified) {
  expect_certified(fly("hello.lua"));
}

TEST_F(Filming, CastleFlyoverPassesItsKeyframes) {
  const Flown flown = fly("castle_flyover.lua");
  expect_certified(flown);
  const Plan plan = read_plan(flown.folder / "plan.json");
  EXPECT_EQ(plan.trajectory.duration(), 20);
  const Eigen::Vector3d top(0, -2, 14);
  double nearest = 1e9;
  for (const Sample& s : plan.trajectory.samples) {
    if (std::abs(s.time - 10) < 0.11) nearest = std::min(nearest, (s.position - top).norm());
  }
  EXPECT_LT(nearest, 0.2);
}

TEST_F(Filming, TwoRunsWriteTheSamePlan) {
  const Flown a = fly("castle_flyover.lua", "", "a");
  const Flown b = fly("castle_flyover.lua", "--threads 1", "b");
  for (const char* file : {"plan.json", "trajectory.csv", "report.html"}) {
    EXPECT_EQ(read_file(a.folder / file), read_file(b.folder / file)) << file;
  }
}

TEST_F(Filming, SofterAndSmootherByConfiguration) {
  // A thousand times the weight on snap: the same film, less snap, larger misses.
  const auto smoothness = [](const Flown& flown, double weight) {
    return flown.result.at("solver").at("terms").at("smoothness").as_number() / weight;
  };
  const Flown stiff = fly("castle_flyover.lua");
  const Flown soft = fly("castle_flyover.lua", "--set weights.smoothness=1", "soft");
  EXPECT_LT(smoothness(soft, 1), smoothness(stiff, 1e-3));
  EXPECT_GT(soft.result.at("solver").at("terms").at("keyframe").as_number(),
            stiff.result.at("solver").at("terms").at("keyframe").as_number());
}

// Rosenbrock's valley as a cost: its floor curves, so that steps along it which never climb are
// short, and 50 of them do not reach the end.
TEST_F(Filming, CurvedValleysTakeFewPrograms) {
  write_file_atomically(folder_ / "valley.lua", R"(return require "mission.film".shot {
    name = "valley", duration = 20, weights = { smoothness = 1e-6, effort = 1e-6, keyframe = 1 },
    keyframes = { { time = 0, position = {-12, 14.4, 5} }, { time = 20, position = {-10, 10, 5} } },
    costs = { { name = "valley", weight = 1000,
                residual = function(s) return s.position.y - s.position.x * s.position.x / 10 end },
              { name = "ahead", weight = 0.1,
                residual = function(s) return s.position.x - 10 end } } })");
  const Value solver = fly((folder_ / "valley.lua").string()).result.at("solver");
  EXPECT_EQ(solver.at("status").as_text(), "optimal");
  EXPECT_LE(solver.at("iterations").as_integer(), 25);
  EXPECT_NEAR(solver.at("cost").as_number(), 221.67332, 2e-4) << "as ipopt finds it";
  // Wherever it ends before, the merit is not above that of the start.
  for (const int most : {1, 2, 3, 4, 5, 6, 7, 8, 12}) {
    const std::string limit = "--set solver.iterations=" + std::to_string(most);
    const Value early = fly((folder_ / "valley.lua").string(), limit, "early").result.at("solver");
    EXPECT_EQ(early.at("status").as_text(), "iteration_limit");
    EXPECT_LE(early.at("cost").as_number(), 1004) << most;
  }
}

// A path that sags between two low keyframes, with and without a ground.
TEST_F(Filming, PathsThatSagIntoNoGroundSaySo) {
  write_file_atomically(folder_ / "low.lua", R"(return require "mission.film".shot {
    name = "low", keyframes = { { time = 0, position = {0, 0, 6} },
      { time = 4, position = {8, 0, 0.6} }, { time = 7, position = {16, 0, 0.6} },
      { time = 12, position = {24, 0, 6} } } })");
  const std::string script = (folder_ / "low.lua").string();
  const auto lowest = [](const Flown& flown) {
    double low = 1e9;
    for (const Sample& s : read_plan(flown.folder / "plan.json").trajectory.samples)
      low = std::min(low, s.position.z());
    return low;
  };
  const Flown open = fly(script);
  EXPECT_LT(lowest(open), 0);
  const std::string note = open.result.at("notes").as_list().at(0).as_text();
  EXPECT_NE(note.find("no ground is stated: `ground = 0`"), std::string::npos) << note;
  for (const char* solver : {"iqp", "ipopt", "nlopt"}) {
    const Flown above = fly(script, std::string("--set ground=0 --set solver=") + solver, solver);
    expect_certified(above);
    EXPECT_GT(lowest(above), 0.5 - 1e-3) << solver;
    EXPECT_EQ(above.result.find("notes"), nullptr);
  }
  const Flown zone = fly(script, "--set volume.lower=[-9,-9,-9] --set volume.upper=[99,9,9]", "in");
  EXPECT_EQ(zone.result.find("notes"), nullptr) << "a flight zone has a floor";
}

TEST_F(Filming, SoftKeyframesBeyondTheVehicleAreExplained) {
  write_file_atomically(folder_ / "there_and_back.lua", R"(return require "mission.film".shot {
    name = "there and back", duration = 2, vehicle = "vehicles/solo",
    keyframes = { { time = 0, position = {0, 0, 2} }, { time = 1, position = {4, 0, 2} },
                  { time = 2, position = {0, 0, 2} } } })");
  const Flown flown = fly((folder_ / "there_and_back.lua").string());
  EXPECT_EQ(flown.status, 1);
  EXPECT_EQ(flown.result.at("status").as_text(), "not_certified");
  EXPECT_EQ(flown.result.at("solver").at("status").as_text(), "optimal");
  const std::string note = flown.result.at("notes").as_list().at(0).as_text();
  EXPECT_NE(note.find("thrust_max"), std::string::npos) << note;
  EXPECT_NE(note.find(" at 0.9 s"), std::string::npos) << note;
}

TEST_F(DesignersShots, AreCertifiedWhereTheVehicleCanFollow) {
  for (const int number :
       {2, 5, 7, 12, 29, 30}) {  // a pause, geodetic, one keyframe, near the limit
    SCOPED_TRACE(number);
    const Flown flown = fly_shot(number);
    expect_certified(flown);
    EXPECT_EQ(flown.result.at("film").at("stretch").as_number(), 1);
  }
}

TEST_F(DesignersShots, EndAtTheirLastKeyframe) {
  const Flown flown = fly_shot(5);  // totalTimeMs says 60 s
  EXPECT_NEAR(read_plan(flown.folder / "plan.json").trajectory.duration(), 20.0785, 1e-3);
}

}  // namespace
}  // namespace lapwing
