// SPDX-License-Identifier: Apache-2.0
// A scan of which some views are not photographed, and the tour of the rest.
#include "framework/geometry/geodetic.h"
#include "framework/photogrammetry/exif_position.h"
#include "tests/gps_photo.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

TEST_F(Scanning, WhatIsNotPhotographedIsFlownAgain) {
  if (!reads_exif()) GTEST_SKIP() << "libexif-dev is not installed";
  const GeodeticPoint origin{47.4, 8.5, 450};
  ASSERT_EQ(run("--set origin.latitude_deg=47.4 --set origin.longitude_deg=8.5 --set "
                "origin.height=450 --set origin.height_of=ellipsoid --set usable.range=30"),
            0)
      << error();
  const Plan made = read_plan(folder_ / "out/plan.json");
  const auto& views = made.task.scan->views;
  ASSERT_GT(views.size(), 6u);
  fs::create_directories(folder_ / "photos");
  for (std::size_t k = 0; k < views.size(); ++k)
    if (k != 3 && k != 4)
      write_file_atomically(folder_ / "photos" / (std::to_string(k) + ".jpg"),
                            gps_photo(to_geodetic(origin, views[k].position)));
  const std::string place = "'" + folder_.string() + "/";
  const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing scan check " + place +
                           "photos' --plan " + place + "out/plan.json' -o " + place +
                           "rest.lua' > " + place + "said.txt'";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1);
  EXPECT_THAT(read_file(folder_ / "said.txt"), HasSubstr("missing: 4, 5\n"));
  ASSERT_EQ(run("--data " + place + "out'", "rest.lua", "rest"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  const Plan rest = read_plan(folder_ / "rest/plan.json");
  for (const std::size_t k : {3u, 4u}) {
    const bool taken = std::any_of(
        rest.task.scan->views.begin(), rest.task.scan->views.end(), [&](const PlannedView& view) {
          return (view.position - views[k].position).norm() < 1e-6 &&
                 std::abs(std::remainder(view.yaw - views[k].yaw, 2 * EIGEN_PI)) < 1e-6 &&
                 std::abs(view.pitch - views[k].pitch) < 1e-6;
        });
    EXPECT_TRUE(taken) << "view " << k + 1;
  }
}

}  // namespace
}  // namespace lapwing
