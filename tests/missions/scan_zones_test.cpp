// SPDX-License-Identifier: Apache-2.0
// Scans of regions between zones, end to end: what they keep, what they say, what is written.
#include "framework/survey/height_raster.h"
#include "tests/missions/scan_hut.h"
#include "tests/obstacles.h"
#include "tests/survey/made_rasters.h"

namespace lapwing {
namespace {

class ZoneScan : public Scanning {
 protected:
  // The hut's mission with more options.
  void write_with(const std::string& name, const std::string& options) {
    write(name, R"(
local scan = require "mission.scan"
local of_scene = scan.of_scene
scan.of_scene = function(given)
  for key, value in pairs { )" +
                    options +
                    R"( } do given[key] = value end
  return of_scene(given)
end
)");
  }
};

TEST_F(ZoneScan, TheTourKeepsZonesAndThePilotsSight) {
  write_with("zones.lua", R"(
    regions = { { name = 'yard', corners = {{-6, -5}, {6, -5}, {6, 0}, {0, 0}, {0, 5}, {-6, 5}},
                  from = -0.4, to = 7, weight = 2 } },
    no_fly_zones = { { name = 'school', corners = {{1, 1}, {14, 1}, {14, 14}, {1, 14}} } },
    flight_zones = { { name = 'estate', corners = {{-16, -16}, {16, -16}, {16, 16}, {-16, 16}},
                       ceiling = 25 } },
    pilot = { position = {-3, -14, 10}, range = 60 }, gps_accuracy = 0.2,)");
  ASSERT_EQ(run("", "zones.lua"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  const Plan read = read_plan(folder_ / "out/plan.json");
  const Certificate certificate = verify(read, folder_ / "out");
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  for (const char* name : {"flight_zone", "pilot_sight", "pilot_distance", "coverage"}) {
    const Check* check = certificate.find(name);
    ASSERT_NE(check, nullptr) << name;
    EXPECT_TRUE(check->skipped.empty()) << name;
  }
  EXPECT_EQ(read.environment.accuracy, 0.2);
  EXPECT_NEAR(read.environment.margin, 0.6, 1e-12);
  ASSERT_TRUE(read.task.scan);
  ASSERT_EQ(read.task.scan->region.prisms().size(), 1u);
  EXPECT_EQ(read.task.scan->region.prisms()[0].weight, 2);
  // The certificate does not believe it: by the samples themselves.
  for (const Sample& s : read.trajectory.samples)
    EXPECT_FALSE(s.position.x() > 0.4 && s.position.y() > 0.4) << s.time;
  EXPECT_THAT(plan(), HasSubstr("images of the first flight, which are left out"));
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("region 'yard', weight 2"));
  // A plan whose zone was made smaller is refused by its own certificate.
  Plan moved = read;
  for (Obstacle& zone : moved.environment.obstacles)
    if (zone.name == "school")
      zone.parameters.set("corners", corners_value({{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}));
  EXPECT_FALSE(verify(moved, folder_ / "out").feasible());
}

class SlowZoneScan : public ZoneScan {};

TEST_F(SlowZoneScan, WhatNoZoneAllowsToBeSeenIsSaidWithItsShare) {
  // Only south of the hut is free; the north wall stays unseen.
  write_with("hidden.lua", R"(
    no_fly_zones = { { name = 'garden', corners = {{-40, 2}, {40, 2}, {40, 40}, {-40, 40}} } },)");
  ASSERT_EQ(run("", "hidden.lua"), 0) << error();
  EXPECT_THAT(plan(), HasSubstr("of its surface that could be seen"));
  EXPECT_THAT(plan(), HasSubstr("stay unseen because of zones"));
  const Value said = answer();
  const Value& holes = said.at("tour").at("prediction").at("holes");
  EXPECT_GT(holes.at("zone").as_number(), 10) << "m^2 of the north wall";
  EXPECT_THAT(plan(), HasSubstr("m^2 because of zones or the pilot's sight"));
}

TEST_F(ZoneScan, HeightsAboveTheGroundFollowTheTerrain) {
  if (!rasters_available()) GTEST_SKIP() << "Lapwing was built without libgdal-dev";
  MadeRaster surface{.width = 48, .height = 48, .left = -12, .upper = 12, .pixel = 0.5};
  surface.height_at = [](double x, double y) { return house_height(x * 1.3, y * 1.3); };
  MadeRaster ground = surface;
  ground.height_at = [](double x, double) { return static_cast<float>(slope_height(x)); };
  write_file_atomically(folder_ / "surface.tif", tiff_bytes(surface));
  write_file_atomically(folder_ / "ground.tif", tiff_bytes(ground));
  write_file_atomically(folder_ / "slope.lua", R"(
return require("mission.scan").of_terrain {
  name = "slope", resolution = 0.5, reach = 5, range = 40, safe_height = 9,
  tour = { budget = 60, iterations = 40 },
  camera = { width = 60, height = 45, focal = 34 },
  surface = { spacing = 0.5, cell = 0.7, trim = 1.5 },
  candidates = { most = 40, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.2, coarse = 30 },
  terrain = { ground = "ground.tif" }, heights = "ground",
  regions = { { corners = {{-6, -6}, {6, -6}, {6, 6}, {-6, 6}}, from = -1, to = 8 } },
  no_fly_zones = { { corners = {{8, 8}, {11, 8}, {11, 11}, {8, 11}}, ceiling = 20 } },
  flight_zones = { { corners = {{-12, -12}, {12, -12}, {12, 12}, {-12, 12}}, ceiling = 30 } },
})");
  ASSERT_EQ(run("--set input=surface.tif --data '" + folder_.string() + "'", "slope.lua"), 0)
      << error();
  const Plan read = read_plan(folder_ / "out/plan.json");
  ASSERT_TRUE(read.task.scan);
  const RegionPrism& prism = read.task.scan->region.prisms().at(0);
  // Within a cell of the raster of what the slope says.
  EXPECT_NEAR(prism.low, slope_height(-6) - 1, 0.1);
  EXPECT_NEAR(prism.high, slope_height(6) + 8, 0.1);
  double closed = 0, open = 0;
  for (const Obstacle& zone : read.environment.obstacles) {
    if (zone.type != "prism") continue;
    (zone.side == Side::keep_inside ? open : closed) = zone.parameters.at("ceiling").as_number();
  }
  EXPECT_NEAR(closed, slope_height(11) + 20, 0.1) << "above the highest ground";
  EXPECT_NEAR(open, slope_height(-12) + 30, 0.1) << "above the lowest ground";
  const Certificate certificate = verify(read, folder_ / "out");
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_THAT(plan(), HasSubstr("the ground within it lies between"));
}

}  // namespace
}  // namespace lapwing
