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
