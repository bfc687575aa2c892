// SPDX-License-Identifier: Apache-2.0
// Polygons with holes and heights from GeoJSON (RFC 7946) and KML (OGC 2.2) files.
//
//   GeoJSON: geometries Polygon and MultiPolygon, alone, of features, of collections. Properties of
//            a feature: name, from, to (or floor, ceiling), weight.
//   KML:     Polygon and MultiGeometry of Placemarks. The same by Data and SimpleData of
//            ExtendedData. Styles and views do not matter.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct SurveyPolygon {
  std::string name;   // "" where the file gives none
  std::string place;  // of messages: "feature 3 'yard'", "Placemark 'yard' at line 12"
  // x is longitude or east, y latitude or north, as in the file; the last corner is not the first
  // one again.
  std::vector<Eigen::Vector2d> outline;
  std::vector<std::vector<Eigen::Vector2d>> holes;
  std::optional<double> from, to, weight;
};

struct PolygonFile {
  std::vector<SurveyPolygon> polygons;  // one at least
  // What the member "crs" of an old GeoJSON file names: "EPSG:28992"; "" is WGS 84.
  std::string system;
};

// `named`: only what has this name is read, and there must be some; "": everything, and what is no
// polygon is an error. `what` begins messages: the name of the file.
//
// InputError, with the place in the file: no JSON or XML, other geometries, rings that are not
// closed or have fewer than three corners, coordinates that are no numbers, heights in coordinates
// that could be above the ellipsoid, the sea or the ground, properties of those names that are no
// numbers, floor beside from, external entities, links to other files.
PolygonFile read_geojson(std::string_view text, const std::string& named, const std::string& what);
PolygonFile read_kml(std::string_view text, const std::string& named, const std::string& what);

// By the ending: .geojson, .json, .kml; .kmz is refused with the command that unpacks it.
PolygonFile read_polygon_file(const std::filesystem::path& path, const std::string& named,
                              const std::string& what);

}  // namespace lapwing
