// SPDX-License-Identifier: Apache-2.0
// Scans of several batteries: two plans and a fleet, and what is refused before anything is flown.
#include "tests/missions/scan_fleet.h"

namespace lapwing {
namespace {

// The smallest: two short tours, all files, and the verdict of another process.
TEST_F(FleetScans, TwoBatteriesMakeTwoPlansAndAFleet) {
  ASSERT_EQ(run("--set batteries=2 --set tour.budget=30"), 0) << error();
  const Value said = answer();
  EXPECT_EQ(said.at("status").as_text(), "ok");
  EXPECT_EQ(said.at("tours").as_list().size(), 2u);
  const Fleet document = fleet();
  EXPECT_EQ(swaps_of(document), 1);
  for (const FleetTour& tour : document.tours) EXPECT_EQ(tour.drone, "1");
  EXPECT_GE(document.tours[1].start,
            document.tours[0].start + plan_of(document.tours[0]).trajectory.duration() + 60);
  EXPECT_FALSE(fs::exists(folder_ / "out/plan.json"));
  for (const char* file : {"report.html", "report_2.html", "trajectory_2.csv", "map.ot"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
}

TEST_F(FleetScans, WhatCannotBeFlownIsOneMessage) {
  EXPECT_THAT(refused_fleet("--set batteries=0"), HasSubstr("expected between 1 and 100,"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set drones=3"),
              HasSubstr("3 drones and 2 batteries"));
  EXPECT_THAT(refused_fleet("--set fleet.swap=10"), HasSubstr("set batteries"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set finish=[0,0,12]"),
              HasSubstr("every tour of several batteries ends where it began"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set drones=2 --set "
                            "'fleet.starts=[{position: [8,8,13]}]'"),
              HasSubstr("expected one start for each of the 2 drones, got 1"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set tour.budget=1180"),
              HasSubstr("more than the 1200 s that one battery"));
}

}  // namespace
}  // namespace lapwing
