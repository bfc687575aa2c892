// SPDX-License-Identifier: Apache-2.0
// Polygons from GeoJSON and KML, as tools write them and as they should not.
#include "framework/survey/polygon_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

const std::string kRing = "[[4.1,52.1],[4.2,52.1],[4.2,52.2],[4.1,52.1]]";
const std::string kHole = "[[4.15,52.11],[4.16,52.11],[4.16,52.12],[4.15,52.11]]";

std::string feature(const std::string& properties, const std::string& geometry) {
  return R"({"type":"Feature","properties":)" + properties + R"(,"geometry":)" + geometry + "}";
}
std::string polygon(const std::string& rings) {
  return R"({"type":"Polygon","coordinates":[)" + rings + "]}";
}
std::string collection(const std::string& features, const std::string& more = "") {
  return R"({"type":"FeatureCollection",)" + more + R"("features":[)" + features + "]}";
}

std::string kml(const std::string& body) {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2">
<Document><name>plan</name><Style id="s"><LineStyle><color>ff0000ff</color></LineStyle></Style>)" +
         body + "</Document></kml>";
}
const std::string kKmlRing =
    "<LinearRing><coordinates>\n 4.1,52.1,0 4.2,52.1,0\n4.2,52.2,0 "
    "4.1,52.1,0 </coordinates></LinearRing>";
std::string placemark(const std::string& inner) {
  return "<Placemark><name> yard </name>" + inner + "</Placemark>";
}
std::string kml_polygon(const std::string& more = "") {
  return "<Polygon>" + more + "<outerBoundaryIs>" + kKmlRing + "</outerBoundaryIs></Polygon>";
}

template <class Read>
std::string refusal(Read read, const std::string& text, const std::string& named = "") {
  try {
    read(text, named, "a.file");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
std::string json_refusal(const std::string& text, const std::string& named = "") {
  return refusal(read_geojson, text, named);
}
std::string kml_refusal(const std::string& text, const std::string& named = "") {
  return refusal(read_kml, text, named);
}

TEST(GeoJson, PolygonsWithHolesAndProperties) {
  const PolygonFile file = read_geojson(
      collection(feature(R"({"name":"yard","from":2,"ceiling":12.5,"weight":3,"owner":"x"})",
                         polygon(kRing + "," + kHole)) +
                 "," +
                 feature("null", R"({"type":"MultiPolygon","coordinates":[[)" + kRing + "],[" +
                                     kHole + "]]}")),
      "", "a.geojson");
  ASSERT_EQ(file.polygons.size(), 3u);
  EXPECT_EQ(file.system, "");
  const SurveyPolygon& yard = file.polygons[0];
  EXPECT_EQ(yard.name, "yard");
  EXPECT_EQ(yard.outline, (std::vector<Vector2d>{{4.1, 52.1}, {4.2, 52.1}, {4.2, 52.2}}));
  ASSERT_EQ(yard.holes.size(), 1u);
  EXPECT_EQ(yard.holes[0][1], Vector2d(4.16, 52.11));
  EXPECT_EQ(yard.from, 2);
  EXPECT_EQ(yard.to, 12.5);
  EXPECT_EQ(yard.weight, 3);
  EXPECT_EQ(file.polygons[2].name, "");
  EXPECT_FALSE(file.polygons[2].from);
}

TEST(GeoJson, OneNameIsTakenFromAFileWithOtherThings) {
  const std::string text =
      collection(feature(R"({"name":"home"})", R"({"type":"Point","coordinates":[4.1,52.1]})") +
                 "," + feature(R"({"name":"yard"})", polygon(kRing)));
  EXPECT_EQ(read_geojson(text, "yard", "a").polygons.size(), 1u);
  EXPECT_THAT(json_refusal(text),
              HasSubstr("feature 1 'home': expected a Polygon or a MultiPolygon, got 'Point'"));
  EXPECT_THAT(json_refusal(text, "barn"),
              HasSubstr("nothing in it is named 'barn'; it has 'home', 'yard'"));
}

TEST(GeoJson, OldFilesNameTheirSystem) {
  const auto system = [](const std::string& name) {
    return read_geojson(
               collection(feature("{}", polygon(kRing)),
                          R"("crs":{"type":"name","properties":{"name":")" + name + R"("}},)"),
               "", "a")
        .system;
  };
  EXPECT_EQ(system("urn:ogc:def:crs:OGC:1.3:CRS84"), "");
  EXPECT_EQ(system("urn:ogc:def:crs:EPSG::4326"), "");
  EXPECT_EQ(system("urn:ogc:def:crs:EPSG::28992"), "EPSG:28992");
  EXPECT_EQ(system("EPSG:28992"), "EPSG:28992");
  EXPECT_THAT(json_refusal(collection(feature("{}", polygon(kRing)),
                                      R"("crs":{"type":"link","properties":{"href":"x"}},)")),
              HasSubstr("crs names no reference system"));
}

TEST(GeoJson, BadFilesGetOneMessageWithThePlace) {
  EXPECT_THAT(json_refusal("{"), HasSubstr("a.file"));
  EXPECT_THAT(json_refusal("[]"), HasSubstr("expected a GeoJSON object"));
  EXPECT_THAT(json_refusal(R"({"type":"Topology"})"), HasSubstr("got 'Topology'"));
  EXPECT_THAT(json_refusal(R"({"type":"FeatureCollection","features":{}})"),
              HasSubstr("has a list 'features'"));
  EXPECT_THAT(json_refusal(collection("")), HasSubstr("it has no polygon"));
  EXPECT_THAT(json_refusal(polygon("[[4.1,52.1],[4.2,52.1],[4.2,52.2],[4.1,52.2]]")),
              HasSubstr("is not closed"));
  EXPECT_THAT(json_refusal(polygon("[[4.1,52.1],[4.2,52.1],[4.1,52.1]]")),
              HasSubstr("at least four positions"));
  EXPECT_THAT(json_refusal(polygon(R"([[4.1,"52"],[4.2,52.1],[4.2,52.2],[4.1,52.1]])")),
              HasSubstr("position 1: expected numbers"));
  EXPECT_THAT(json_refusal(polygon("[[4.1],[4.2,52.1],[4.2,52.2],[4.1]]")),
              HasSubstr("position 1: expected a list of longitude and latitude"));
  EXPECT_THAT(json_refusal(polygon("[[4.1,52.1,7],[4.2,52.1],[4.2,52.2],[4.1,52.1]]")),
              HasSubstr("have heights (7 m at its corner 1)"));
  EXPECT_THAT(json_refusal(feature(R"({"from":"2"})", polygon(kRing))),
              HasSubstr("property 'from': expected a number, got a text"));
  EXPECT_THAT(json_refusal(feature(R"({"from":2,"floor":3})", polygon(kRing))),
              HasSubstr("stated twice"));
  EXPECT_THAT(json_refusal(R"({"type":"Feature","properties":{}})"), HasSubstr("no geometry"));
}

TEST(Kml, PolygonsWithHolesAndExtendedData) {
  const std::string inner =
      "<innerBoundaryIs><LinearRing><coordinates>4.15,52.11 4.16,52.11 4.16,52.12 "
      "4.15,52.11</coordinates></LinearRing></innerBoundaryIs>";
  const PolygonFile file = read_kml(
      kml("<Folder>" +
          placemark("<ExtendedData><Data name=\"from\"><value>2</value></Data>"
                    "<SchemaData><SimpleData name=\"ceiling\">12.5</SimpleData></SchemaData>"
                    "<Data name=\"colour\"><value>red</value></Data></ExtendedData>"
                    "<MultiGeometry><Polygon><outerBoundaryIs>" +
                    kKmlRing + "</outerBoundaryIs>" + inner + "</Polygon>" + kml_polygon() +
                    "</MultiGeometry>") +
          "</Folder>"),
      "", "a.kml");
  ASSERT_EQ(file.polygons.size(), 2u);
  EXPECT_EQ(file.polygons[0].name, "yard");
  EXPECT_EQ(file.polygons[0].outline,
            (std::vector<Vector2d>{{4.1, 52.1}, {4.2, 52.1}, {4.2, 52.2}}));
  ASSERT_EQ(file.polygons[0].holes.size(), 1u);
  EXPECT_EQ(file.polygons[0].holes[0][1], Vector2d(4.16, 52.11));
  EXPECT_EQ(file.polygons[1].from, 2);
  EXPECT_EQ(file.polygons[1].to, 12.5);
}

TEST(Kml, BadFilesGetOneMessageWithThePlace) {
  EXPECT_THAT(kml_refusal("<kml><Document>"), HasSubstr("a.file, line 1: no sound XML"));
  EXPECT_THAT(kml_refusal("<gpx/>"), HasSubstr("expected the element 'kml', got 'gpx'"));
  EXPECT_THAT(kml_refusal("<!DOCTYPE kml [<!ENTITY a \"b\">]><kml/>"),
              HasSubstr("document type is refused"));
  EXPECT_THAT(kml_refusal(kml("")), HasSubstr("it has no polygon"));
  EXPECT_THAT(kml_refusal(kml("<NetworkLink><Link><href>x</href></Link></NetworkLink>")),
              HasSubstr("NetworkLink"));
  const std::string point = placemark("<Point><coordinates>4.1,52.1</coordinates></Point>");
  EXPECT_THAT(kml_refusal(kml(point)),
              HasSubstr("Placemark 'yard' at line 3: expected a Polygon, got a Point"));
  EXPECT_THAT(kml_refusal(kml(placemark("")), "barn"), HasSubstr("it has 'yard'"));
  EXPECT_THAT(kml_refusal(kml(placemark("<Polygon/>"))), HasSubstr("no outerBoundaryIs"));
  const auto with = [&](const std::string& coordinates, const std::string& mode = "") {
    return kml_refusal(
        kml(placemark("<Polygon>" + mode + "<outerBoundaryIs><LinearRing><coordinates>" +
                      coordinates + "</coordinates></LinearRing></outerBoundaryIs></Polygon>")));
  };
  EXPECT_THAT(with("4.1,52.1 4.2;52.1 4.2,52.2 4.1,52.1"),
              HasSubstr("position 2: expected 'longitude,latitude'"));
  EXPECT_THAT(with("4.1,52.1 4.2,52.1 4.2,52.2 4.3,52.1"), HasSubstr("is not closed"));
  EXPECT_THAT(with("4.1,52.1,5,6 4.2,52.1 4.2,52.2 4.1,52.1"), HasSubstr("position 1"));
  const std::string high = "4.1,52.1,0 4.2,52.1,30 4.2,52.2,30 4.1,52.1,0";
  EXPECT_EQ(with(high), "accepted") << "clamped to the ground by the standard's default";
  EXPECT_THAT(with(high, "<altitudeMode>absolute</altitudeMode>"),
              HasSubstr("have heights (30 m at its corner 2)"));
  EXPECT_THAT(kml_refusal(kml(placemark("<ExtendedData><Data name=\"to\"><value>high</value>"
                                        "</Data></ExtendedData>" +
                                        kml_polygon()))),
              HasSubstr("'to': expected a number, got 'high'"));
}

}  // namespace
}  // namespace lapwing
