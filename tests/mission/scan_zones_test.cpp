// SPDX-License-Identifier: Apache-2.0
// Regions, zones and heights of scans as users state them: what is wrong is said before planning.
#include <gmock/gmock.h>

#include "framework/survey/reference_system.h"
#include "tests/mission/hut_scene.h"
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

constexpr const char* kOrigin =
    "origin = { latitude_deg = 52.0116, longitude_deg = 4.3571, height = 0, "
    "height_of = 'ellipsoid' }, ";

class ScanZones : public MissionTest {
 protected:
  void SetUp() override { write_hut_scene(folder_); }

  std::string said(const std::string& options) {
    return error(
        "return require('mission.scan').of_scene { name = 'hut', scene = 'hut', "
        "safe_height = 12, resolution = 0.5, camera = { width = 60, height = 45, focal = 34 "
        "},\n" +
        options + " }");
  }
  // With a region of one outline.
  std::string region(const std::string& corners, const std::string& more = "") {
    return said("regions = { { name = 'yard', corners = " + corners + ", from = 0, to = 6 } }," +
                more);
  }
  // With a region of a file.
  std::string file(const std::string& name, const std::string& text,
                   const std::string& more = kOrigin) {
    write_file_atomically(folder_ / name, text);
    return said("regions = { { file = '" + name + "', from = 0, to = 6 } }, " + more);
  }
  static std::string geojson(const std::string& ring, const std::string& more = "") {
    return R"({"type": "FeatureCollection", )" + more +
           R"("features": [{"type": "Feature", "properties": {"name": "yard"}, "geometry": )" +
           R"({"type": "Polygon", "coordinates": [)" + ring + "]}}]}";
  }
};

TEST_F(ScanZones, OutlinesThatBoundNoAreaAreRefused) {
  EXPECT_THAT(region("{{0, 0}, {5, 0}, {10, 0}}"), HasSubstr("regions[1]"));
  EXPECT_THAT(region("{{0, 0}, {5, 5}, {5, 0}, {0, 5}}"),
              HasSubstr("its edges 1 and 3 cross or touch near (2.5, 2.5)"));
  EXPECT_THAT(region("{{0, 0}, {5, 5}}"), HasSubstr("at least three"));
  EXPECT_THAT(said("regions = { { corners = {{0, 0}, {9, 0}, {0, 9}}, from = 3, to = 3 } }"),
              HasSubstr("3 m and 3 m"));
  EXPECT_THAT(said("regions = { { corners = {{0, 0}, {9, 0}, {0, 9}}, to = 3 } }"),
              HasSubstr("from is missing"));
  EXPECT_THAT(said("regions = { { corners = {{0, 0}, {9, 0}, {0, 9}}, from = 0, to = 3, holes = { "
                   "{ corners = {{-1, 1}, {2, 1}, {1, 2}} } } } }"),
              HasSubstr("hole 1: it must lie within the outline"));
  EXPECT_THAT(
      region("{{0, 0}, {9, 0}, {0, 9}}", "region = { lower = {0, 0, 0}, upper = {1, 1, 1} }"),
      HasSubstr("a region is stated as well"));
}

TEST_F(ScanZones, PlacesOnTheEarthNeedAnOriginAndHeightsTheirReference) {
  const std::string there =
      "regions = { { corners_deg = {{52.0115, 4.357}, {52.0117, 4.357}, "
      "{52.0117, 4.3573}}, from = 0, to = 6 } }, ";
  EXPECT_THAT(said(there), HasSubstr("the mission has no origin"));
  EXPECT_THAT(said(there + kOrigin), HasSubstr("state heights = \"ground\""));
  EXPECT_THAT(said(there + kOrigin + "heights = 'ground'"), HasSubstr("state ground_level"));
  EXPECT_THAT(said(there + "heights = 'sea', origin = { latitude_deg = 52.0116, longitude_deg = "
                           "4.3571, height = 0, height_of = 'ground' }"),
              HasSubstr("its heights are above the sea"));
  EXPECT_THAT(said("ground_level = 3, region = { lower = {0, 0, 0}, upper = {1, 1, 1} }, "
                   "no_fly_zones = { { corners = {{0, 0}, {9, 0}, {0, 9}} } }"),
              HasSubstr("ground_level: is for heights above the ground"));
  EXPECT_THAT(said(there + "heights = 'ground', ground_level = 2, origin = { latitude_deg = "
                           "52.0116, longitude_deg = 4.3571, height = 1, height_of = 'ground' }"),
              HasSubstr("origin.height says that the ground is at -1 m"));
}

TEST_F(ScanZones, FilesInOtherCoordinatesAreRefused) {
  const std::string whole =
      "[[4.3570, 52.0115], [4.3573, 52.0115], [4.3573, 52.0117], [4.3570, 52.0115]]";
  const std::string swapped =
      "[[52.0115, 4.3570], [52.0115, 4.3573], [52.0117, 4.3573], [52.0115, 4.3570]]";
  const std::string metres = "[[85000, 446000], [85020, 446000], [85020, 446020], [85000, 446000]]";
  const std::string dutch =
      R"("crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::28992"}}, )";
  EXPECT_THAT(file("a.geojson", geojson(swapped)),
              HasSubstr("are longitude and latitude exchanged"));
  EXPECT_THAT(file("b.geojson", geojson(metres)), HasSubstr("state coordinates = \"EPSG:...\""));
  EXPECT_THAT(file("c.geojson", geojson(metres, dutch)),
              HasSubstr("state coordinates = \"EPSG:28992\""));
  EXPECT_THAT(file("d.geojson", geojson(whole)), HasSubstr("state heights"));
  EXPECT_THAT(file("e.geojson", geojson(whole.substr(0, whole.size() - 20) + "]")),
              HasSubstr("a ring has at least four positions"));
  EXPECT_THAT(file("f.kmz", "PK"), HasSubstr("unzip"));
  EXPECT_THAT(file("g.shp", "x"), HasSubstr("expected a file .geojson, .json or .kml"));
  const std::string missing = said("regions = { { file = 'i.geojson', from = 0, to = 6 } }");
  EXPECT_THAT(missing, HasSubstr(": regions[1].file: data file 'i.geojson' not found in "));
  EXPECT_EQ(missing.find("regions[1]"), missing.rfind("regions[1]")) << missing;
  if (!ReferenceSystem::available()) return;
  EXPECT_THAT(file("h.geojson", geojson("[[5, 5], [6, 5], [6, 6], [5, 5]]"),
                   std::string(kOrigin) + "coordinates = 'EPSG:28992', heights = 'ground'"),
              HasSubstr("regions[1]"));
}

TEST_F(ScanZones, ZonesThatCloseTheStartInAreRefused) {
  const auto around = [](const char* half) {
    const std::string h = half;
    return "no_fly_zones = { { name = 'school', corners = {{-" + h + ", -" + h + "}, {" + h +
           ", -" + h + "}, {" + h + ", " + h + "}, {-" + h + ", " + h + "}} } }, ";
  };
  EXPECT_THAT(said(around("40")), HasSubstr("forbid all"));
  EXPECT_THAT(said(around("3") + "start = {0, 0, 14}"),
              HasSubstr("start: it lies in zone 'school'"));
  EXPECT_THAT(said(around("3") + "start = {3.5, 0, 14}"), HasSubstr("too near"));
  EXPECT_THAT(said("pilot = { range = 90 }"), HasSubstr("state pilot.position as well"));
  EXPECT_THAT(said("pilot = { position = {0, -20, 2}, range = 5 }, start = {0, 0, 14}"),
              HasSubstr("m from the pilot, whose range is 5 m"));
  EXPECT_THAT(said(around("3") + "exploration = { images = 20 }"),
              HasSubstr("an exploration keeps no zones"));
  EXPECT_THAT(said("no_fly_zones = { { corners = {{0, 0}, {5, 5}, {5, 0}, {0, 5}} } }"),
              HasSubstr("no_fly_zones[1]: its edges 1 and 3 cross"));
}

// Where only a first flight is asked for and there is none, nothing is planned in its place.
TEST_F(ScanZones, WhereThereIsNoFirstFlightNoneIsTold) {
  write_file_atomically(folder_ / "shot.lua", R"(return require('mission.scan').of_scene {
    name = 'hut', scene = 'hut', resolution = 0.5, exploration = { images = 3 },
    start = {-15, 0, 5}, camera = { width = 60, height = 45, focal = 34 } })");
  int told = 0;
  MissionSettings alone = settings();
  alone.observe_first_flight = [&](const Value&) { ++told; };
  alone.first_flight_alone = true;
  Mission mission(folder_ / "shot.lua", alone);
  mission.configure({}, {});
  EXPECT_THROW(mission.plan(), Cancelled);
  EXPECT_EQ(told, 0);
  EXPECT_FALSE(mission.planning_began());
}

// Four walls of zones around the home, without a way out.
TEST_F(ScanZones, ZonesThatCloseTheHomeInAreRefused) {
  std::string zones = "no_fly_zones = { ";
  for (const char* corners : {"{{-24, -24}, {-16, -24}, {-16, -22}, {-24, -22}}",
                              "{{-24, -18}, {-16, -18}, {-16, -16}, {-24, -16}}",
                              "{{-24, -22}, {-22, -22}, {-22, -18}, {-24, -18}}",
                              "{{-18, -22}, {-16, -22}, {-16, -18}, {-18, -18}}"})
    zones += "{ corners = " + std::string(corners) + " }, ";
  zones += "}, body = {0.4, 0.4, 0.3}, margin = 0.2, home = { position = {-20, -20, 0} }, ";
  EXPECT_THAT(said(zones), HasSubstr("home: zones close it in"));
}

}  // namespace
}  // namespace lapwing
