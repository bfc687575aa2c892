// SPDX-License-Identifier: Apache-2.0
// Scans over surveyors' data end to end: a house on a slope as a point cloud and as a raster.
#include "framework/map/map_file.h"
#include "framework/survey/city_model.h"
#include "framework/survey/height_raster.h"
#include "framework/survey/reference_system.h"
#include "tests/missions/scan_hut.h"
#include "tests/survey/made_cities.h"
#include "tests/survey/made_rasters.h"

namespace lapwing {
namespace {

constexpr const char* kSmall = R"(
  resolution = 0.5, reach = 5, range = 40, safe_height = 9, tour = { budget = 60, iterations = 40 },
  usable = { range = 30 },
  camera = { width = 60, height = 45, focal = 34 },
  surface = { spacing = 0.5, cell = 0.7, trim = 1.5 },
  candidates = { most = 40, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.2, coarse = 30 },
}
)";

class SiteScan : public Scanning {
 protected:
  void SetUp() override {
    Scanning::SetUp();
    for (const char* source : {"cloud", "terrain"})
      write_file_atomically(folder_ / (std::string(source) + ".lua"),
                            "return require('mission.scan').of_" + std::string(source) +
                                " { name = '" + source + "'," + kSmall);
  }

  // Of 24 m x 24 m around the house.
  static std::vector<Eigen::Vector3d> house() {
    std::vector<Eigen::Vector3d> points = house_on_slope(0.3);
    std::erase_if(points, [](const Eigen::Vector3d& p) {
      return std::abs(p.x()) > 12 || std::abs(p.y()) > 12;
    });
    return points;
  }

  int run_on(const std::string& input, const std::string& source = "cloud",
             const std::string& more = "") {
    return run("--set input=" + input + " --data '" + folder_.string() + "' " + more,
               source + ".lua", "out");
  }
  std::string refusal(const std::string& input, const std::string& source = "cloud",
                      const std::string& more = "") {
    fs::remove_all(folder_ / "out");
    EXPECT_EQ(run_on(input, source, more), 2) << error();
    EXPECT_FALSE(fs::exists(folder_ / "out/plan.json"));
    return error();
  }

  // The state of the written map at a place.
  VoxelState state_at(const Eigen::Vector3d& p) const {
    const MapFile file = read_map_file(folder_ / "out/map.ot");
    const VoxelGrid grid(file.resolution);
    const VoxelKey key = grid.key(p);
    for (const VoxelLeaf& leaf : file.leaves) {
      const auto within = [&](int axis) {
        return key[axis] >> leaf.level == leaf.key[axis] >> leaf.level;
      };
      if (within(0) && within(1) && within(2))
        return leaf.log_odds > 0 ? VoxelState::occupied : VoxelState::free;
    }
    return VoxelState::unknown;
  }

  void expect_certified() {
    EXPECT_EQ(answer().at("status").as_text(), "ok");
    const Certificate certificate = verify(read_plan(folder_ / "out/plan.json"), folder_ / "out");
    for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  }
};

TEST_F(SiteScan, ACloudIsScannedAndCertified) {
  std::vector<Eigen::Vector3d> points = house();
  MadeLas las{.minor = 4, .format = 6};
  las.classes.assign(points.size(), 1);
  points.emplace_back(0, 0, 300);  // a bird
  las.classes.push_back(18);
  points.emplace_back(3, 3, -60);  // an echo that no class tells
  las.classes.push_back(1);
  write_file_atomically(folder_ / "house.las", las_bytes(points, las));
  ASSERT_EQ(run_on("house.las"), 0) << error();
  expect_certified();
  EXPECT_EQ(state_at({-8, 8, 3}), VoxelState::free) << "above the slope";
  EXPECT_EQ(state_at({0, 4.2, 1.2}), VoxelState::free) << "beside the wall";
  EXPECT_EQ(state_at({0, 0, 7}), VoxelState::free) << "above the roof";
  EXPECT_EQ(state_at({0, 0, 5}), VoxelState::occupied) << "the roof";
  EXPECT_EQ(state_at({0, 3, 2.2}), VoxelState::occupied) << "the wall";
  EXPECT_EQ(state_at({0.2, 0.2, 2.2}), VoxelState::unknown) << "in the house";
  EXPECT_EQ(state_at({0.2, -4.2, 1.2}), VoxelState::unknown) << "under the canopy";
  EXPECT_EQ(state_at({13.5, 0.2, 5}), VoxelState::unknown) << "beyond the cloud";
  const std::string plan = this->plan();
  EXPECT_THAT(plan, HasSubstr("1 of classes that are left out, 1 (thinned) far from all others"));
  EXPECT_THAT(plan, HasSubstr("free below safe_height: open sky"));
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("Knowledge before the tour"));
}

TEST_F(SiteScan, ScannersMakeTheAirUnderACanopyFree) {
  std::vector<Eigen::Vector3d> points = house();
  // What a scanner south of the house sees under the canopy: the ground and the wall.
  for (double x = -3.9; x < 4; x += 0.3) {
    for (double y = -5; y < -3; y += 0.3) points.emplace_back(x, y, slope_height(x));
    for (double z = slope_height(x) + 0.15; z < 3; z += 0.3) points.emplace_back(x, -3, z);
  }
  write_file_atomically(folder_ / "house.xyz", lines_of(points));
  ASSERT_EQ(run_on("house.xyz", "cloud",
                   "--set 'cloud.scanners=[{position: [0, -9, 1.5]}]' --set cloud.free=both"),
            0)
      << error();
  expect_certified();
  EXPECT_EQ(state_at({0.2, -4.2, 1.2}), VoxelState::free) << "under the canopy";
  EXPECT_EQ(state_at({0.2, 0.2, 2.2}), VoxelState::unknown) << "in the house";
}

TEST_F(SiteScan, ARasterIsScannedAndCertified) {
  if (!rasters_available()) GTEST_SKIP() << "Lapwing was built without libgdal-dev";
  MadeRaster surface{.width = 48, .height = 48, .left = -12, .upper = 12, .pixel = 0.5};
  surface.height_at = [](double x, double y) { return house_height(x * 1.3, y * 1.3); };
  MadeRaster ground = surface;
  ground.height_at = [](double x, double) { return static_cast<float>(slope_height(x)); };
  write_file_atomically(folder_ / "surface.tif", tiff_bytes(surface));
  write_file_atomically(folder_ / "ground.tif", tiff_bytes(ground));
  // Terrain heights as scripts ask for them.
  const std::string script = read_file(folder_ / "terrain.lua");
  write_file_atomically(folder_ / "terrain.lua", R"(
local first = require "mission.scan_site"
local notes = first.notes
first.notes = function(run, views)
  local site = run:read_terrain { file = "surface.tif", ground = "ground.tif", resolution = 0.5 }
  local outside = site:ground(99, 0)
  local all = notes(run, views)
  all[#all + 1] = string.format("ground %.3f %s", site:ground(1, 0), tostring(outside))
  return all
end
)" + script);
  ASSERT_EQ(run_on("surface.tif", "terrain", "--set terrain.ground=ground.tif"), 0) << error();
  expect_certified();
  EXPECT_EQ(state_at({-8, 8, 3}), VoxelState::free) << "above the slope";
  EXPECT_EQ(state_at({0.2, 0.2, 7}), VoxelState::free) << "above the roof";
  EXPECT_EQ(state_at({0.2, 0.2, 2.2}), VoxelState::occupied) << "in the house";
  EXPECT_EQ(state_at({11.7, 11.7, 3.2}), VoxelState::unknown) << "no data";
  EXPECT_THAT(plan(), HasSubstr("ground 0.100 nil"));
  EXPECT_THAT(plan(), HasSubstr("has no data and stays unknown"));
}

TEST_F(SiteScan, WhatIsWrongIsSaidAndNothingIsWritten) {
  const std::vector<Eigen::Vector3d> points = house();
  const auto file = [&](const std::string& name, const std::string& bytes) {
    write_file_atomically(folder_ / name, bytes);
    return name;
  };
  const std::string las = las_bytes(points, {});
  EXPECT_THAT(refusal(file("cut.las", las.substr(0, las.size() / 2))), HasSubstr("cut short"));
  EXPECT_THAT(refusal(file("town.laz", las_bytes(points, {.other_user = "laszip encoded"}))),
              HasSubstr("pdal translate"));
  EXPECT_THAT(refusal(file("three.xyz", "1 2 3\n4 5 6\n7 8 9\n")),
              HasSubstr("a cloud of 3 points"));
  EXPECT_THAT(refusal(file("nan.xyz", "nan nan nan\nnan nan nan\n")),
              HasSubstr("none of its 2 points can be used"));
  std::vector<Eigen::Vector3d> far = points;
  for (Eigen::Vector3d& p : far) p += Eigen::Vector3d(1e6, 5e6, 100);
  EXPECT_THAT(refusal(file("far.xyz", lines_of(far))), HasSubstr("cloud.zero = {"));
  std::vector<Eigen::Vector3d> degrees = points;
  for (Eigen::Vector3d& p : degrees) p = {4.36 + 1e-5 * p.x(), 52 + 1e-5 * p.y(), p.z()};
  EXPECT_THAT(refusal(file("degrees.xyz", lines_of(degrees))), HasSubstr("EPSG:4326"));
  EXPECT_THAT(refusal("none.las"), HasSubstr("none.las"));
  EXPECT_THAT(refusal(file("a.xyz", lines_of(points)), "cloud", "--set safe_height=4"),
              HasSubstr("the data reach up to 5"));
  EXPECT_THAT(refusal("a.xyz", "cloud", "--set rounds=2"), HasSubstr("rounds"));
  EXPECT_THAT(refusal("a.xyz", "cloud", "--set ground=true"), HasSubstr("simulated first flight"));
  EXPECT_THAT(refusal("a.xyz", "cloud", "--set terrain.system=EPSG:28992"),
              HasSubstr("is for scan.of_terrain"));
  EXPECT_THAT(refusal("a.xyz", "cloud", "--set cloud.free=scanners"),
              HasSubstr("needs cloud.scanners"));
  EXPECT_THAT(refusal("a.xyz", "cloud", "--set cloud.without=noise"), HasSubstr("classes"));
  EXPECT_THAT(refused("--set cloud.system=EPSG:28992"), HasSubstr("is for scan.of_cloud"));
  if (!rasters_available()) return;
  MadeRaster raster{.placed = false};
  EXPECT_THAT(refusal(file("picture.tif", tiff_bytes(raster)), "terrain"),
              HasSubstr("no georeferencing"));
  raster = {.left = 6e5, .upper = 5.8e6};
  EXPECT_THAT(refusal(file("far.tif", tiff_bytes(raster)), "terrain"),
              HasSubstr("terrain.system = "));
}

// The same house in the Dutch grid and by the mission's origin: the same frame.
TEST_F(SiteScan, AReferenceSystemLeadsToTheMissionsOrigin) {
  if (!ReferenceSystem::available()) GTEST_SKIP() << "Lapwing was built without libproj-dev";
  std::vector<Eigen::Vector3d> points = house();
  for (Eigen::Vector3d& p : points) p += Eigen::Vector3d(155000, 463000, 0);
  MadeLas las{.offset = {155000, 463000, 0}};
  las.keys = {1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 28992};
  write_file_atomically(folder_ / "house.las", las_bytes(points, las));
  const GeodeticPoint there = ReferenceSystem::of("EPSG:28992").to_geodetic({155000, 463000, 0});
  char origin[300];
  std::snprintf(origin, sizeof origin,
                "--set origin.latitude_deg=%.9f --set origin.longitude_deg=%.9f "
                "--set origin.height=0 --set origin.height_of=ellipsoid",
                there.latitude_deg, there.longitude_deg);
  ASSERT_EQ(run_on("house.las", "cloud", origin), 0) << error();
  expect_certified();
  EXPECT_EQ(state_at({0.2, 0.2, 5}), VoxelState::occupied) << "the roof";
  EXPECT_THAT(plan(), HasSubstr("Amersfoort / RD New"));
}

// Of a house in national coordinates, above whose middle the world's origin is.
class CityScan : public SiteScan {
 protected:
  void SetUp() override {
    if (!city_models_available()) GTEST_SKIP() << "Lapwing was built without libcitygml-dev";
    SiteScan::SetUp();
    write_file_atomically(folder_ / "mesh.lua",
                          std::string("return require('mission.scan').of_mesh { name = 'city', "
                                      "ground = true, flights = { { pattern = 'ellipse', views = "
                                      "8, reach = 3, pitch_deg = -40, height = 14 }, { pattern = "
                                      "'meander', views = 12, reach = 1, height = 13 } },") +
                              kSmall);
  }
  void write_city(const std::string& system, const Eigen::Vector3d& middle) {
    write_file_atomically(
        folder_ / "town.gml",
        city_gml(gml_building(gml_solid(1, gml_box(middle - Eigen::Vector3d(4, 3, 0),
                                                   middle + Eigen::Vector3d(4, 3, 5)))),
                 system));
  }
};

TEST_F(CityScan, AHouseInNationalCoordinatesIsScanned) {
  if (!ReferenceSystem::available()) GTEST_SKIP() << "Lapwing was built without libproj-dev";
  write_city("urn:ogc:def:crs:EPSG::28992", {84800.5, 447500.25, 0});
  ASSERT_EQ(run_on("town.gml", "mesh"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  const Value region = from_json(plan(), "plan").at("task").at("scan").at("region");
  // 6 m around it: see the README.
  EXPECT_NEAR(region.at("lower").as_list()[0].as_number(), -10, 0.8);
  EXPECT_NEAR(region.at("upper").as_list()[1].as_number(), 9, 0.8);
  EXPECT_THAT(read_file(folder_ / "out/run.log"), HasSubstr("CityGML, 1 object of level 1, 12"));
}

TEST_F(CityScan, BadModelsAreOneMessage) {
  write_city("", {84800.5, 447500.25, 0});
  EXPECT_THAT(refusal("town.gml", "mesh"), HasSubstr("city.zero"));
  EXPECT_THAT(refusal("town.gml", "mesh", "--set up=y"),
              HasSubstr("up: is for a mesh file; heights of a city model point up"));
  write_city("EPSG:999999", {84800.5, 447500.25, 0});
  EXPECT_THAT(refusal("town.gml", "mesh"), HasSubstr("999999"));
  EXPECT_THAT(refusal("town.gml", "mesh", "--set city.zero=[1,2,3]"), HasSubstr("city.zero"));
  write_file_atomically(folder_ / "town.gml", "<half");
  EXPECT_THAT(refusal("town.gml", "mesh"), HasSubstr("its XML is damaged or cut short"));
  write_file_atomically(folder_ / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(refusal("a.obj", "mesh", "--set city.system=EPSG:28992"),
              HasSubstr("city.system: is for a city model"));
}

}  // namespace
}  // namespace lapwing
