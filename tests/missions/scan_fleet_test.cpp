// SPDX-License-Identifier: Apache-2.0
// Scans of several batteries: two plans and a fleet, and what is refused before anything is flown.
#include "tests/missions/scan_fleet.h"

namespace lapwing {
namespace {

// The smallest: two short tours, all files. Both plans keep the zone and the accuracy.
TEST_F(FleetScans, TwoBatteriesMakeTwoPlansAndAFleet) {
  ASSERT_EQ(run(std::string("--set batteries=2 --set tour.budget=25 --set gps_accuracy=0.2 --set "
                            "resolution=0.8 --set surface.spacing=1.5 --set camera.width=40 --set "
                            "camera.height=30 --set camera.focal=23 ") +
                kPond),
            0)
      << error();
  const Value said = answer();
  EXPECT_EQ(said.at("status").as_text(), "ok");
  EXPECT_EQ(said.at("tours").as_list().size(), 2u);
  const Fleet document = fleet();
  EXPECT_EQ(swaps_of(document), 1);
  for (const FleetTour& tour : document.tours) EXPECT_EQ(tour.drone, "1");
  EXPECT_GE(document.tours[1].start,
            document.tours[0].start + plan_of(document.tours[0]).trajectory.duration() + 60);
  for (const FleetTour& tour : document.tours) {
    const Environment kept = plan_of(tour).environment;
    EXPECT_EQ(kept.accuracy, 0.2);
    EXPECT_NE(find_obstacle(kept, "prism", "pond"), nullptr);
  }
  // What the images show is told of both tours together.
  EXPECT_GT(said.at("tour").at("prediction").as_map().size(), 0u);
  EXPECT_EQ(said.at("tours").as_list()[0].at("tour").find("prediction"), nullptr);
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("the 2 tours see"));
  EXPECT_FALSE(fs::exists(folder_ / "out/plan.json"));
  for (const char* file : {"report.html", "report_2.html", "trajectory_2.csv", "map.ot",
                           "prediction.ply", "prediction.glb"})
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
              HasSubstr("expected as many starts as drones, 2, got 1"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set tour.budget=1180"),
              HasSubstr("more than the 1200 s that one battery"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set tour.begin=recursive_greedy"),
              HasSubstr("tour.begin: recursive_greedy plans one tour, not several that share one "
                        "score; expected one of: cost_benefit, greedy, local_search"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set exploration.images=20 --set flights=[]"),
              HasSubstr("an exploration and its tour share one battery"));
  EXPECT_THAT(refused_fleet(std::string(kPond) +
                            " --set batteries=2 --set drones=2 --set "
                            "'fleet.starts=[{position: [-8,-8,13]}, {position: [10,-10,13]}]'"),
              HasSubstr("fleet.starts: the start of drone 2: it lies in zone 'pond'"));
  EXPECT_THAT(refused_fleet("--set accuracy=0"), HasSubstr("accuracy: expected above 0"));
  EXPECT_THAT(refused_fleet("--set accuracy_share=0.5"), HasSubstr("set accuracy"));
  EXPECT_THAT(refused_fleet("--set accuracy=0.1 --set accuracy_share=1.1"),
              HasSubstr("accuracy_share: expected above 0 and at most 1"));
  EXPECT_THAT(refused_fleet("--set accuracy=0.1 --set batteries=2 --set drones=3"),
              HasSubstr("3 drones and 2 batteries"));
}

}  // namespace
}  // namespace lapwing
