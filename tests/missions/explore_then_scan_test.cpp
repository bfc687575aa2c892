// SPDX-License-Identifier: Apache-2.0
// An exploration and a scan in one visit.
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

class ExploringThenScanning : public Scanning {
 protected:
  void write_both(const std::string& more) {
    write_file_atomically(folder_ / "both.lua", R"(
local scan = require "mission.scan"
return scan.of_scene {
  name = "hut", scene = "hut", resolution = 0.4, body = { 0.5, 0.5, 0.5 },
  exploration = { images = 10, start = { 0, -11, 4 }, start_yaw_deg = 90 }, utility = "frontier",
  tour = { budget = 60, iterations = 20 }, closed_loop = "reported",
  surface = { spacing = 0.8, cell = 1, trim = 2 },
  candidates = { most = 30, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.3, coarse = 40 },)" + more + "\n}\n");
  }
};

class SlowExploringThenScanning : public ExploringThenScanning {};

// The tour begins where the exploration ended, in the map that it made.
TEST_F(SlowExploringThenScanning, TheTourIsPlannedOnWhatWasExplored) {
  write_both("");
  ASSERT_EQ(run("", "both.lua"), 0) << error();
  const Value result = answer();
  EXPECT_EQ(result.at("status").as_text(), "ok");
  EXPECT_GT(result.at("tour").at("score").as_number(), 0);
  const Value& notes = result.at("notes");
  EXPECT_THAT(notes.as_list().front().as_text(), HasSubstr("explored first: 10 depth images"));
  const double explored = result.at("tour").at("explored_seconds").as_number();
  EXPECT_GT(explored, 10);  // nine ways of 2.5 m or a turn, ten rests
  EXPECT_LT(explored, 200);
  const std::string report = read_file(folder_ / "out/report.html");
  for (const char* section : {"Growth of the map", "Candidates at the last step"})
    EXPECT_THAT(report, HasSubstr(section));
  const Plan read = read_plan(folder_ / "out/plan.json");
  EXPECT_EQ(read.environment.obstacles.at(1).parameters.at("file").as_text(), "map.ot");
  EXPECT_EQ(read.environment.obstacles.at(0).parameters.at("file").as_text(), "prior.ply");
  for (const Check& check : verify(read, folder_ / "out").failures())
    ADD_FAILURE() << to_line(check);
}

TEST_F(ExploringThenScanning, WhatCannotBeIsSaid) {
  write_both(" flights = { { pattern = 'meander' } },");
  EXPECT_NE(run("", "both.lua"), 0);
  EXPECT_THAT(error(), HasSubstr("replaces flights"));
  write_both(" prior = { map = 'a.ot', mesh = 'a.ply' },");
  EXPECT_NE(run("", "both.lua"), 0);
  EXPECT_THAT(error(), HasSubstr("remove them"));
  write_both("");
  for (const auto& [more, expected] : std::vector<std::pair<const char*, const char*>>{
           {"exploration.images=0 --set utility=frontir", "did you mean 'frontier'?"},
           {"exploration.images=0", "set exploration.images"},
           {"map='{type: brick, hit: 0.7}'", "the map of an exploration has hit 0.9"},
           {"exploration.speed=50", "is not certified: speed_across"},
           {"exploration.images=1", "at least 2"}}) {
    EXPECT_EQ(run(std::string("--set ") + more, "both.lua"), 2) << more;
    EXPECT_THAT(error(), HasSubstr(expected)) << more;
  }
  // One battery, for both.
  write_both("");
  EXPECT_EQ(run("--set exploration.budget=1150", "both.lua"), 2);
  EXPECT_THAT(error(), HasSubstr("1150 s of it and a tour of 60 s are more than one battery"));
  EXPECT_EQ(run("--set tour.budget=1200", "both.lua"), 2);
  EXPECT_THAT(error(), HasSubstr("a tour of 1200 s uses the whole battery"));
  EXPECT_EQ(run("--set tour.budget=1199", "both.lua"), 2);
  EXPECT_THAT(error(),
              HasSubstr("it ended after one image (of 1 s it had): the next view is beyond"));
  // It stays where the tour may go.
  EXPECT_EQ(run("--set floor=5", "both.lua"), 2);
  EXPECT_THAT(error(), HasSubstr("the start lies outside the bounds"));
}

}  // namespace
}  // namespace lapwing
