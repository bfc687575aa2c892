// SPDX-License-Identifier: Apache-2.0
// Scans end to end: a hut that is made here, flown over, planned on what that showed, and judged.
#include <regex>

#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

TEST_F(Scanning, AHutIsScannedAndCertified) {
  ASSERT_EQ(run(""), 0) << error();
  const Value result = answer();
  EXPECT_EQ(result.at("status").as_text(), "ok");
  EXPECT_EQ(result.at("solver").at("name").as_text(), "local_search");
  const Value& tour = result.at("tour");
  EXPECT_GT(tour.at("score").as_number(), 0);
  EXPECT_GE(tour.at("upper_bound").as_number(), tour.at("score").as_number());
  EXPECT_NEAR(tour.at("gap").as_number(),
              1 - tour.at("score").as_number() / tour.at("upper_bound").as_number(), 1e-9);
  EXPECT_LE(tour.at("seconds").as_number(), 70);
  const Plan read = read_plan(folder_ / "out/plan.json");
  const Certificate certificate = verify(read, folder_ / "out");
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  for (const Check& check : certificate.checks)
    for (const char* made : {"clearance", "budget", "closed_loop", "coverage", "view_miss"})
      if (check.name == made) {
        EXPECT_TRUE(check.skipped.empty()) << made;
      }
  ASSERT_TRUE(read.task.scan.has_value());
  EXPECT_EQ(static_cast<std::int64_t>(read.task.scan->views.size()),
            tour.at("images").as_integer());
  EXPECT_LE(read.trajectory.duration(), 70);
  // Legs, one by one, take what the whole flight takes, turns on the spot included.
  EXPECT_NEAR(read.trajectory.duration(), tour.at("seconds").as_number(), 1);
  EXPECT_EQ(plan().find("sees the floor of the region"), std::string::npos);
  EXPECT_EQ(read.environment.obstacles.at(1).parameters.at("file").as_text(), "map.ot");
  EXPECT_EQ(read.environment.obstacles.at(0).parameters.at("file").as_text(), "prior.ply");
  const std::string report = read_file(folder_ / "out/report.html");
  for (const char* section : {"Knowledge of the first flight", "Candidates", "One view",
                              "Information over the budget", "Coverage"})
    EXPECT_THAT(report, HasSubstr(section));
}

// The true mesh is for the first flight alone: without it from then on, on another number of
// threads, the same bytes come out.
TEST_F(Scanning, PlanningKnowsWhatTheFirstFlightSawAndNothingElse) {
  write("blind.lua", R"(
local first = require "mission.scan_first"
local knowledge = first.knowledge
first.knowledge = function(run)
  local known, poses, surface = knowledge(run)
  surface:discard()
  local seen = pcall(function() return surface:clearance({0, 0, 9}) end)
  if seen then error("the mesh is still there") end
  return known, poses, surface
end
)");
  ASSERT_EQ(run("--threads 2"), 0) << error();
  ASSERT_EQ(run("--threads 1", "blind.lua", "blind"), 0) << error();
  EXPECT_EQ(plan("blind"), plan());
  EXPECT_EQ(read_file(folder_ / "blind/map.ot"), read_file(folder_ / "out/map.ot"));
  EXPECT_EQ(read_file(folder_ / "blind/prior.ply"), read_file(folder_ / "out/prior.ply"));
}

// The scores that solvers came to, in the order of the log.
std::vector<std::pair<std::string, double>> scores_in(const std::string& log) {
  std::vector<std::pair<std::string, double>> all;
  const std::regex line(R"((\w+): \w+, score ([0-9.]+), )");
  for (auto at = std::sregex_iterator(log.begin(), log.end(), line); at != std::sregex_iterator();
       ++at)
    all.emplace_back((*at)[1], std::stod((*at)[2]));
  return all;
}

TEST_F(Scanning, TheSearchStartsFromTheBetterOfTwoTours) {
  ASSERT_EQ(run(""), 0) << error();
  const auto found = scores_in(read_file(folder_ / "out/run.log"));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].first, "cost_benefit");
  EXPECT_EQ(found[1].first, "recursive_greedy");
  EXPECT_EQ(found[2].first, "local_search");
  EXPECT_GE(found[1].second, found[0].second) << "a better tour to begin with is kept";
  EXPECT_GE(found[2].second, found[1].second);
  ASSERT_EQ(run("--set tour.begin=greedy", "hut.lua", "one"), 0) << error();
  EXPECT_EQ(scores_in(read_file(folder_ / "one/run.log"))[0].first, "greedy");
  EXPECT_EQ(scores_in(read_file(folder_ / "one/run.log")).size(), 2u);
  ASSERT_EQ(run("--set tour.begin=none", "hut.lua", "none"), 0) << error();
  EXPECT_EQ(scores_in(read_file(folder_ / "none/run.log")).size(), 1u);
}

class SlowScanning : public Scanning {};

TEST_F(SlowScanning, ASecondPlanContinuesFromFilesOfTheFirst) {
  ASSERT_EQ(run(""), 0) << error();
  const std::string files =
      "--set prior.map=out/map.ot --set prior.mesh=out/prior.ply --data '" + folder_.string() + "'";
  write_file_atomically(folder_ / "again.lua", R"(
return require("mission.scan").of_prior {
  name = "again", resolution = 0.4, range = 30, reach = 8, safe_height = 9, ceiling = 15,
  region = { lower = {-6, -5, -0.4}, upper = {6, 5, 7} }, start = {0, 0, 13},
  usable = { range = 30 },
  tour = { budget = 70, iterations = 60 }, camera = { width = 80, height = 60, focal = 46 },
  candidates = { most = 60, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.3, coarse = 40 },
}
)");
  ASSERT_EQ(run(files, "again.lua", "again"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  // A mesh of another place.
  write_file_atomically(folder_ / "far.obj", "v 500 0 0\nv 501 0 0\nv 500 1 0\nf 1 2 3\n");
  EXPECT_EQ(run(files + " --set prior.mesh=far.obj", "again.lua", "again"), 2);
  EXPECT_THAT(error(), HasSubstr("does not fit the map"));
  EXPECT_EQ(run(files + " --set resolution=0.3", "again.lua", "again"), 2);
  EXPECT_THAT(error(), HasSubstr("voxels of"));
}

TEST_F(SlowScanning, ATourEndsWhereItIsToldTo) {
  ASSERT_EQ(run("--set start=[-8,-7,11] --set finish=[8,7,12]"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  const Plan made = read_plan(folder_ / "out/plan.json");
  const auto& views = made.task.scan->views;
  ASSERT_GT(views.size(), 5u);
  EXPECT_LT((views.front().position - Eigen::Vector3d(-8, -7, 11)).norm(), 1e-9);
  EXPECT_LT((views.back().position - Eigen::Vector3d(8, 7, 12)).norm(), 1e-9);
  EXPECT_THAT(refused("--set finish=[0,0,2]"), HasSubstr("no free finish: at (0, 0, 2)"));
  EXPECT_THAT(refused("--set finish=[500,0,12]"), HasSubstr("no free finish"));
}

TEST_F(SlowScanning, ASecondRoundKnowsWhatTheFirstOneSaw) {
  ASSERT_EQ(run("--set rounds=2", "hut.lua", "twice"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  ASSERT_EQ(run("", "hut.lua", "once"), 0) << error();
  EXPECT_NE(read_file(folder_ / "twice/map.ot"), read_file(folder_ / "once/map.ot"));
  EXPECT_NE(read_file(folder_ / "twice/prior.ply"), read_file(folder_ / "once/prior.ply"));
}

TEST_F(SlowScanning, NoiseOfDepthIsPlannedWith) {
  ASSERT_EQ(run("--set noise.sigma=0.05 --set noise.dropped=0.2"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  const std::string noisy = read_file(folder_ / "out/map.ot");
  ASSERT_EQ(run(""), 0) << error();
  EXPECT_NE(noisy, read_file(folder_ / "out/map.ot"));
}

TEST_F(SlowScanning, WhatCannotBePlannedIsSaid) {
  EXPECT_THAT(refused("--set start=[0,0,2]"), HasSubstr("no free start"));
  EXPECT_THAT(refused("--set tour.budget=1"), HasSubstr("no tour of 1 s"));
  EXPECT_THAT(refused("--set region.lower=[15,15,2] --set region.upper=[20,20,6]"),
              HasSubstr("has no surface"));
  EXPECT_THAT(refused("--set region.lower=[-6,-5,30] --set region.upper=[6,5,33] "
                      "--set safe_height=9"),
              HasSubstr("must fly above 32 m"));
  EXPECT_THAT(refused("--set motions.alpha=1"), HasSubstr("connected to the start"));
  // The roof is seen and the ground is not: the plan says so.
  ASSERT_EQ(run("--set range=13", "hut.lua", "short"), 0) << error();
  EXPECT_THAT(plan("short"), HasSubstr("no first flight sees the floor of the region"));
  // Most of the battery is left over.
  ASSERT_EQ(run("--set candidates.most=12 --set tour.budget=900", "hut.lua", "little"), 0);
  EXPECT_THAT(plan("little"), testing::ContainsRegex("the tour takes 1[0-9]+ of 900 s"));
  EXPECT_EQ(plan("short").find("the tour takes"), std::string::npos);
  EXPECT_THAT(refused("--set safe_height=5"), HasSubstr("up to 6 m"));
  // A name alone swaps the solver and keeps the budget, and what is another solver's is said.
  EXPECT_THAT(refused("--set tour=greedy"), HasSubstr("tour.iterations: unknown key"));
  EXPECT_THAT(refused("--set tour.budget=1300"), HasSubstr("more than one battery, 1200 s"));
  EXPECT_THAT(refused("--set up=y"), HasSubstr("up: is for the mesh file"));
  EXPECT_THAT(refused("--set tour.begin=gredy"), HasSubstr("did you mean 'greedy'?"));
  EXPECT_THAT(refused("--set scene=walls"), HasSubstr("not a scene"));
  EXPECT_THAT(refused("--set scene=churhc"), HasSubstr("did you mean 'church'?"));
  EXPECT_THAT(refused("--set prior.map=a.ot"), HasSubstr("both a map and a mesh"));
  // What contradicts is said before anything is flown.
  EXPECT_THAT(refused("--set tour.budget_metres=300"), HasSubstr("give one of them"));
  EXPECT_THAT(refused("--set tour.images=1"), HasSubstr("at least two"));
  EXPECT_THAT(refused("--set 'tour={solver: greedy, begin: cost_benefit}'"), HasSubstr("begin"));
  EXPECT_THAT(refused("--set input=hut.obj"), HasSubstr("in place of the scene 'hut'"));
  EXPECT_THAT(refused("--set ground=true"), HasSubstr("ground: is for the mesh file"));
  EXPECT_THAT(refused("--set region.lower=[6,-5,0] --set region.upper=[-6,5,7]"),
              HasSubstr("lower must be below upper: 6 and -6 along x"));
  EXPECT_THAT(refused("--set ceiling=3"), HasSubstr("3 m is below safe_height, 9 m"));
  EXPECT_THAT(refused("--set range=3"), HasSubstr("no first flight sees the region"));
  EXPECT_THAT(refused("--set resolution=0.01"), HasSubstr("choose a coarser resolution"));
  EXPECT_THAT(refused("--set body=[1,0,1]"), HasSubstr("half edges must be above 0"));
  write_file_atomically(folder_ / "none.lua",
                        "return require('mission.scan').of_mesh { name = 'none' }\n");
  EXPECT_EQ(run("", "none.lua"), 2);
  EXPECT_THAT(error(), HasSubstr("--set input=PATH"));
}

}  // namespace
}  // namespace lapwing
