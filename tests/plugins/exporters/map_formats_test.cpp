// SPDX-License-Identifier: Apache-2.0
// kml, gpx and geojson: what a map program finds in the files, by code of its own.
#include <gmock/gmock.h>

#include <regex>

#include "framework/core/json.h"
#include "framework/trajectory/interpolate.h"
#include "tests/plugins/exporters/placed_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::Not;

struct MapFormat {
  const char* name;
  Value heights_of_ground;  // parameters
};
std::vector<MapFormat> map_formats() {
  return {{"kml", Value::map()},
          {"gpx", with("heights", "ground")},
          {"geojson", with("heights", "ground")}};
}

// Latitude, longitude and height of the points of the path.
std::vector<Eigen::Vector3d> points_in(const std::string& format, const std::string& text) {
  std::vector<Eigen::Vector3d> points;
  if (format == "geojson") {
    const Value document = from_json(text, "test");
    for (const Value& p :
         document.at("features").as_list()[0].at("geometry").at("coordinates").as_list())
      points.emplace_back(p.as_list()[1].as_number(), p.as_list()[0].as_number(),
                          p.as_list()[2].as_number());
    return points;
  }
  const bool gpx = format == "gpx";
  const std::string number = "(-?[0-9.]+)";
  const std::regex point(gpx ? "<trkpt lat=\"" + number + "\" lon=\"" + number + "\"><ele>" +
                                   number + "</ele></trkpt>"
                             : "\n" + number + "," + number + "," + number);
  for (std::sregex_iterator found(text.begin(), text.end(), point), end; found != end; ++found) {
    const double a = std::stod((*found)[1]), b = std::stod((*found)[2]);
    points.emplace_back(gpx ? a : b, gpx ? b : a, std::stod((*found)[3]));
  }
  return points;
}

TEST(MapFormats, CoordinatesAreThoseOfThePlan) {
  const Plan plan = placed_plan();
  for (const MapFormat& format : map_formats()) {
    const auto exporter = exporter_named(format.name, format.heights_of_ground);
    const std::string text = exporter->write(plan);
    const auto points = points_in(format.name, text);
    ASSERT_EQ(points.size(), 21u) << format.name;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d place = from_origin({kLatitude, kLongitude, 2}, points[i]);
      const double miss = (place - sample_at(plan.trajectory, i / 10.0).position).norm();
      EXPECT_LT(miss, 1e-3) << format.name;
    }
    const auto said = exporter->losses(plan, text);
    EXPECT_THAT(said[0], HasSubstr("origin 46.5191, 6.5668 at 2 m above the ground there; "
                                   "21 points, heights from 5 m to 7 m above the ground"));
    // The sagitta of a chord of 0.1 rad on a circle of 10 m is 1.25 cm.
    EXPECT_THAT(said[1], HasSubstr("at most 1.25 cm")) << format.name;
  }
}

TEST(MapFormats, TheLossIsReadFromTheFile) {
  const Plan plan = placed_plan();
  for (const MapFormat& format : map_formats()) {
    const auto exporter = exporter_named(format.name, format.heights_of_ground);
    std::string text = exporter->write(plan);
    text.replace(text.find("46.51"), 5, "46.52");
    EXPECT_THAT(exporter->losses(plan, text)[1], Not(HasSubstr("at most 1.25 cm"))) << format.name;
  }
}

TEST(MapFormats, HeightsAreConvertedWhereTheOriginTells) {
  const auto height = [](const char* format, const Plan& plan, Value parameters) {
    return points_in(format, exporter_named(format, parameters)->write(plan))[0].z();
  };
  const Plan sea = placed_plan(HeightOf::sea, 400),
             ellipsoid = placed_plan(HeightOf::ellipsoid, 448);
  EXPECT_NEAR(height("kml", sea, Value::map()), 403, 1e-3);
  EXPECT_NEAR(height("gpx", sea, Value::map()), 403, 1e-3);
  EXPECT_NEAR(height("geojson", sea, Value::map()), 451, 1e-3);
  EXPECT_NEAR(height("geojson", ellipsoid, Value::map()), 451, 1e-3);
  // Between ellipsoid and sea lies the geoid, which is not guessed.
  setenv("GEOGRAPHICLIB_GEOID_PATH", "/nowhere", 1);
  for (const char* format : {"gpx", "kml"})
    EXPECT_THAT(refusal_of(*exporter_named(format), ellipsoid),
                testing::AllOf(HasSubstr("geographiclib-get-geoids"),
                               HasSubstr("`--format gpx:heights=ellipsoid`")));
  EXPECT_EQ(refusal_of(*exporter_named("gpx", with("heights", "ellipsoid")), ellipsoid), "");
  unsetenv("GEOGRAPHICLIB_GEOID_PATH");
  for (const char* format : {"gpx", "geojson"})
    EXPECT_THAT(refusal_of(*exporter_named(format), placed_plan()),
                HasSubstr("the origin states one above the ground at the origin"));
  EXPECT_THAT(refusal_of(*exporter_named("kml", with("heights", "ground")), sea),
              HasSubstr("heights in the file are above the ground"));
}

TEST(MapFormats, HoldPlacesAndZonesByTheirNames) {
  Plan plan = placed_plan();
  plan.task.keyframes.push_back({1.5, {1, 2, 3}});
  Subject subject;
  subject.name = "Tom & <\"Jerry\x01'>";
  subject.times = {0};
  subject.positions = {{0, 0, 1}};
  plan.environment.subjects.push_back(subject);
  Obstacle zone;
  zone.name = "a < b";
  zone.type = "prism";
  zone.parameters.set("corners", Value(Value::List{0.0, 0.0, 0.0, 9.0, 9.0, 9.0}));
  zone.parameters.set("ceiling", 12.0);
  plan.environment.obstacles.push_back(zone);
  const std::string kml = exporter_named("kml")->write(plan);
  EXPECT_THAT(kml,
              HasSubstr("<name>A &amp; B &lt;&quot;Übersicht&quot;&gt; (not certified)</name>"));
  EXPECT_THAT(kml, HasSubstr("Tom &amp; &lt;&quot;Jerry\xef\xbf\xbd&#39;&gt;"));
  EXPECT_THAT(kml, HasSubstr("a &lt; b"));
  EXPECT_THAT(kml, HasSubstr("<extrude>1</extrude>"));
  EXPECT_THAT(kml, HasSubstr("1.5 s after the start"));
  const std::string gpx = exporter_named("gpx", with("heights", "ground"))->write(plan);
  EXPECT_THAT(gpx, HasSubstr("Tom &amp; &lt;&quot;Jerry\xef\xbf\xbd&#39;&gt;"));
  const Value json =
      from_json(exporter_named("geojson", with("heights", "ground"))->write(plan), "test");
  const auto& features = json.at("features").as_list();
  ASSERT_EQ(features.size(), 4u);
  EXPECT_FALSE(json.at("certified").as_boolean());
  EXPECT_EQ(features[1].at("properties").at("time").as_number(), 1.5);
  EXPECT_EQ(features[2].at("properties").at("name").as_text(), "Tom & <\"Jerry\x01'>");
  EXPECT_NEAR(features[3].at("properties").at("ceiling").as_number(), 14, 1e-3);
  // Rings are closed, and counter-clockwise seen from above.
  const auto& ring = features[3].at("geometry").at("coordinates").as_list()[0].as_list();
  ASSERT_EQ(ring.size(), 4u);
  EXPECT_EQ(ring[0], ring[3]);
  double area = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto &a = ring[i].as_list(), &b = ring[i + 1].as_list();
    area += (b[0].as_number() - a[0].as_number()) * (a[1].as_number() + b[1].as_number() - 93);
  }
  EXPECT_LT(area, 0);
  plan.certificate = with("feasible", true);
  EXPECT_THAT(exporter_named("kml")->write(plan), Not(HasSubstr("not certified")));
}

TEST(MapFormats, GeojsonRefusesTheDateLine) {
  const auto geojson = exporter_named("geojson", with("heights", "ground"));
  Plan plan = placed_plan();  // within 10 m of the origin, on both sides of it
  plan.geodetic_origin->longitude_deg = 180;
  EXPECT_EQ(refusal_of(*geojson,
                       [&] {
                         Plan east = plan;
                         for (Sample& s : east.trajectory.samples) s.position.x() += 20;
                         return east;
                       }()),
            "");
  EXPECT_THAT(refusal_of(*geojson, plan),
              testing::AllOf(HasSubstr("the path crosses the date line"), HasSubstr("RFC 7946")));
  plan.geodetic_origin->longitude_deg = 179.9;
  EXPECT_EQ(refusal_of(*geojson, plan), "");
  Obstacle zone;
  zone.name = "bay";
  zone.type = "prism";
  zone.parameters.set("corners", Value(Value::List{0.0, 0.0, 20000.0, 0.0, 0.0, 900.0}));
  plan.environment.obstacles.push_back(zone);
  EXPECT_THAT(refusal_of(*geojson, plan), HasSubstr("zone 'bay' crosses the date line"));
}

TEST(MapFormats, ViewsHaveTheirDirection) {
  Plan plan = placed_plan();
  plan.task.scan.emplace();
  plan.task.scan->views.push_back({0.5, {1, 2, 3}, 0.0, -0.5});
  const std::string kml = exporter_named("kml")->write(plan);
  EXPECT_THAT(kml, HasSubstr("<heading>90.0000</heading><tilt>61.3521</tilt>"));
}

TEST(MapFormats, RefuseWhatTheyCannotHold) {
  for (const MapFormat& format : map_formats()) {
    const auto exporter = exporter_named(format.name, format.heights_of_ground);
    Plan homeless = placed_plan();
    homeless.geodetic_origin.reset();
    EXPECT_THAT(refusal_of(*exporter, homeless),
                testing::AllOf(HasSubstr(std::string(format.name) + ": "),
                               HasSubstr("has no origin on the earth"),
                               HasSubstr("--origin LAT,LON,HEIGHT,OF")));
    Plan still = placed_plan();
    still.trajectory.samples.resize(1);
    EXPECT_THAT(refusal_of(*exporter, still), HasSubstr("has no length"));
    Plan none = placed_plan();
    none.trajectory.samples.clear();
    EXPECT_THAT(refusal_of(*exporter, none), HasSubstr("has no samples"));
    Plan lost = placed_plan();
    lost.trajectory.samples[3].position.y() = std::nan("");
    EXPECT_THAT(refusal_of(*exporter, lost), HasSubstr("not finite"));
    EXPECT_THROW(exporter_named(format.name, with("rate", 0)), InputError);
    EXPECT_THROW(exporter_named(format.name, with("heights", "AMSL")), InputError);
  }
}

}  // namespace
}  // namespace lapwing
