// SPDX-License-Identifier: Apache-2.0
// Scans whose first flight was real: depth images of a hall, made here with the errors of a sensor,
// in a world whose y points down.
#include "framework/core/png.h"
#include "tests/missions/hall_images.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

class ScanningImages : public Scanning {
 protected:
  void SetUp() override {
    Scanning::SetUp();
    write_hall_images(folder_ / "images");
    write_file_atomically(folder_ / "hut.lua", R"(
return require("mission.scan").of_images {
  name = "hall", folder = "images", resolution = 0.2,
  body = {0.3, 0.3, 0.2}, mesh_room = 0.1, margin = 0.1, floor = 0.5, reach = 0,
  tour = { budget = 40, iterations = 20 }, effort = { pixels = 60 },
  camera = { width = 80, height = 60, focal = 46 }, usable = { range = 30 },
  surface = { spacing = 0.3, cell = 0.4, trim = 0.8 },
  candidates = { most = 50, step = 1, distance_apart = 0.5 },
  motions = { alpha = 0.3, coarse = 40 },
}
)");
  }
};

TEST_F(ScanningImages, AreThePriorOfATour) {
  ASSERT_EQ(run(""), 0) << error();
  const Plan read = read_plan(folder_ / "out/plan.json");
  for (const Check& check : verify(read, folder_ / "out").failures())
    ADD_FAILURE() << to_line(check);
  EXPECT_THAT(plan(), HasSubstr("images.up = {"));
  // The world of the plan has z up: the hall's floor and ceiling are its lowest and highest.
  const Eigen::AlignedBox3d& region = read.task.scan->region.bounds();
  EXPECT_GE(region.sizes().z(), 3.9);  // whole voxels outwards, and the noise
  EXPECT_LE(region.sizes().z(), 4.5);
  EXPECT_NEAR(region.sizes().x(), 12, 0.6);
  for (const PlannedView& view : read.task.scan->views) EXPECT_TRUE(region.contains(view.position));
  const Value result = answer();
  EXPECT_GT(result.at("tour").at("surface").at("seen").as_number(), 20);
}

TEST_F(ScanningImages, BadFoldersAreRefused) {
  EXPECT_THAT(refused("--set folder=absent"), HasSubstr("absent"));
  EXPECT_THAT(refused("--set scene=church"), HasSubstr("the images of the folder are the first"));
  EXPECT_THAT(refused("--set body=[3,3,1]"), HasSubstr("--config scan/room"));
  EXPECT_THAT(refused("--set body=[1.6,1.6,1.9]"), HasSubstr("places before the cameras"));
  EXPECT_THAT(refused("--set images.depth=x.png"), HasSubstr("one *"));
  EXPECT_THAT(refused("--set images.up=[0,0,0]"), HasSubstr("no direction"));
  write_file_atomically(folder_ / "images/03.depth.png",
                        encode_grey16_png(Grey16{60, 90, std::vector<std::uint16_t>(5400, 2000)}));
  EXPECT_THAT(refused(""), HasSubstr("60 by 90 pixels among those of 120 by 90"));
  fs::remove(folder_ / "images/05.pose.txt");
  EXPECT_THAT(refused(""), HasSubstr("its pose 05.pose.txt is missing"));
  write_file_atomically(folder_ / "images/05.pose.txt", "2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  EXPECT_THAT(refused(""), HasSubstr("no rotation"));
}

}  // namespace
}  // namespace lapwing
