// SPDX-License-Identifier: Apache-2.0
// The three examples that a surveyor begins with, from script to plans, with less effort than they
// state. Each tour is flown in simulation: its images see what was planned.
#include <iterator>

#include "tests/missions/hall_images.h"
#include "tests/missions/scan_fleet.h"
#include "tests/missions/seen_in_flight.h"

namespace lapwing {
namespace {

class SiteExamples : public FleetScans {
 protected:
  int plan_example(const std::string& example, const std::string& more) {
    const std::string line =
        std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" + (kExamples / example).string() +
        "' --json --quiet --out '" + (folder_ / "out").string() + "' " + more + " > '" +
        (folder_ / "stdout.json").string() + "' 2> '" + (folder_ / "stderr.txt").string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  void expect_flown(const std::vector<Plan>& plans) {
    constexpr int kStride = 6;
    const std::shared_ptr<const Map> map = map_in(folder_ / "out/map.ot");
    std::set<VoxelKey> planned, flown, both;
    for (const Plan& plan : plans)
      ASSERT_TRUE(see_planned_and_flown(plan, *map, planned, flown, kStride));
    std::set_intersection(planned.begin(), planned.end(), flown.begin(), flown.end(),
                          std::inserter(both, both.end()));
    std::printf("planned %zu voxels, seen in flight %zu, both %zu\n", planned.size(), flown.size(),
                both.size());
    ASSERT_GT(planned.size(), 100u);
    EXPECT_GE(static_cast<double>(flown.size()), 0.95 * static_cast<double>(planned.size()));
    // Of rays so far apart, those of a flight that is some cm aside meet other voxels.
    EXPECT_GE(static_cast<double>(both.size()), 0.85 * static_cast<double>(planned.size()));
  }
  std::vector<Plan> plans_of_fleet() {
    std::vector<Plan> plans;
    for (const FleetTour& tour : fleet().tours) plans.push_back(plan_of(tour));
    return plans;
  }
};

TEST_F(SiteExamples, AQuarterWithZonesAndFourBatteries) {
  ASSERT_EQ(plan_example("../scan/quarter.lua", "--config scan/small"), 0) << error();
  const std::vector<Plan> plans = plans_of_fleet();
  EXPECT_GE(plans.size(), 2u);
  EXPECT_EQ(verify_again("out"), 0) << verified();  // also what all of them see together
  expect_flown(plans);
}

TEST_F(SiteExamples, ATownSquareBySquare) {
  ASSERT_EQ(plan_example("../scan/town.lua",
                         "--set scene_districts=1 --set batteries=2 --set drones=2 "
                         "--set candidates.most=300 --set effort.pixels=120"),
            0)
      << error();
  EXPECT_EQ(verify_again("out"), 0) << verified();
  expect_flown(plans_of_fleet());
}

TEST_F(SiteExamples, PhotographsOfOnesOwn) {
  write_hall_images(folder_ / "images");
  ASSERT_EQ(plan_example("../scan/own_photos.lua",
                         "--set folder=images --data '" + folder_.string() +
                             "' --config scan/room --set tour.budget=60 --set effort.pixels=120"),
            0)
      << error();
  EXPECT_EQ(verify_again("out/plan.json"), 0) << verified();
  expect_flown({read_plan(folder_ / "out/plan.json")});
}

}  // namespace
}  // namespace lapwing
