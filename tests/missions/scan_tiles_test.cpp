// SPDX-License-Identifier: Apache-2.0
// Scans of large regions, square by square, on a region that is small enough to be compared with.
#include "framework/trajectory/plan.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

using TiledScans = Scanning;

TEST_F(TiledScans, SquaresChooseAsGoodViewsAsTheWhole) {
  const std::string many = "--set candidates.most=240 --set tour.iterations=300 ";
  ASSERT_EQ(run(many, "hut.lua", "whole"), 0) << error();
  const double whole = answer().at("tour").at("score").as_number();
  const std::string few =
      "--set candidates.most=60 --set tour.iterations=300 --set tiles.edge=6 "
      "--set tiles.halo=4 --set tiles.pixels=40 ";
  ASSERT_EQ(run(few), 0) << error();
  const Value said = answer();
  EXPECT_EQ(said.at("status").as_text(), "ok");
  EXPECT_GE(said.at("tour").at("score").as_number(), 0.9 * whole);
  EXPECT_THAT(read_file(folder_ / "out/run.log"), HasSubstr("4 squares, in which "));
  const std::string once = plan();
  ASSERT_EQ(run(few + "--threads 1", "hut.lua", "again"), 0) << error();
  EXPECT_EQ(plan("again"), once);
}

// The squares share the batteries of a fleet.
TEST_F(TiledScans, OfAFleet) {
  ASSERT_EQ(run("--set tiles.edge=6 --set tiles.halo=4 --set batteries=2 --set tour.budget=40"), 0)
      << error();
  EXPECT_EQ(answer().at("tours").as_list().size(), 2u);
}

TEST_F(TiledScans, RefuseWhatTheyDoNotTake) {
  EXPECT_THAT(refused("--set tiles.halo=5"), HasSubstr("tiles.halo: is for squares of the region: "
                                                       "set tiles.edge"));
  EXPECT_THAT(refused("--set tiles.edge=0"), HasSubstr("tiles.edge: expected above 0"));
  EXPECT_THAT(refused("--set tiles.edge=6 --set rounds=2"), HasSubstr("squares are for one round"));
  EXPECT_THAT(refused("--set tiles.edge=6 --set tiles.pool=0.5"),
              HasSubstr("tiles.pool: expected between 1 and 100"));
  EXPECT_THAT(refused("--set scene_districts=3"),
              HasSubstr("scene_districts: is for the scene 'town', not for 'hut'"));
}

}  // namespace
}  // namespace lapwing
