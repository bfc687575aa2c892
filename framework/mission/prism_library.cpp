// SPDX-License-Identifier: Apache-2.0
// Regions and zones as scripts state them: by corners, or by files of surveyors.
#include <lua.hpp>

#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_objects.h"
#include "framework/survey/local_prisms.h"

namespace lapwing {
namespace {

ParameterTable ring_table() {
  ParameterTable table;
  table.optional_numbers("corners", 0, "", "x and y of each corner, in order")
      .optional_numbers("corners_deg", 0, "deg", "latitude and longitude of each corner, in order");
  return table;
}

ParameterTable prisms_table() {
  ParameterTable table = ring_table();
  table.text("name", "", "name in messages")
      .text("file", "", "GeoJSON or KML file, in place of corners")
      .text("named", "", "only polygons of this name are taken from the file")
      .tables("holes", ring_table(), "polygons that do not belong to it")
      .optional_number("low", "m", "lower end, where the file gives none")
      .optional_number("high", "m", "upper end, where the file gives none")
      .optional_number("weight", "", "weight, where the file gives none")
      .text("coordinates", "",
            "reference system of corners and of GeoJSON files; empty: metres "
            "in the world, and WGS 84")
      .choice("heights", "", {"", "world", "ground", "sea", "ellipsoid"},
              "what heights are above; empty: not stated")
      .optional_number("ground_level", "m", "height of level ground, world")
      .text("what", "polygon", "what messages call it");
  return table;
}

// "" where neither or both are given.
std::vector<Eigen::Vector2d> ring_of(const Parameters& given, bool degrees,
                                     const std::string& place) {
  const char* key = degrees ? "corners_deg" : "corners";
  if (!given.has(key) || given.has(degrees ? "corners" : "corners_deg"))
    throw InputError(place + ": expected " + key + ", as its outline has them");
  const auto numbers = given.numbers(key);
  if (numbers.size() < 6 || numbers.size() % 2 != 0)
    throw InputError(place + ": " + key + ": expected at least three pairs");
  std::vector<Eigen::Vector2d> ring;
  for (std::size_t i = 0; i < numbers.size(); i += 2)  // x is the longitude
    ring.emplace_back(numbers[i + (degrees ? 1 : 0)], numbers[i + (degrees ? 0 : 1)]);
  return ring;
}

// Its polygons, and the system that they are in.
std::vector<SurveyPolygon> polygons_of(const Parameters& given, const MissionRun& run,
                                       PrismReference& reference) {
  const std::string file = given.text("file"), place = given.text("what");
  const bool plain = given.has("corners"), degrees = given.has("corners_deg");
  if (static_cast<int>(plain) + static_cast<int>(degrees) + static_cast<int>(!file.empty()) != 1)
    throw InputError("expected one of corners, corners_deg and file");
  const std::string named = given.text("named");
  if (file.empty()) {
    if (!named.empty()) throw InputError("named: is for a file");
    reference.system = degrees                             ? PolygonSystem::degrees
                       : given.text("coordinates").empty() ? PolygonSystem::local
                                                           : PolygonSystem::named;
    SurveyPolygon polygon;
    polygon.name = given.text("name");
    polygon.place = place;
    polygon.outline = ring_of(given, degrees, place);
    for (const Parameters& hole : given.tables("holes"))
      polygon.holes.push_back(
          ring_of(hole, degrees, place + ", hole " + std::to_string(polygon.holes.size() + 1)));
    return {polygon};
  }
  if (!given.tables("holes").empty()) throw InputError("holes: a file has holes of its own");
  PolygonFile read = read_polygon_file(run.files.find(file, "sites"), named, "'" + file + "'");
  const bool kml = file.ends_with(".kml") || file.ends_with(".KML");
  const std::string& stated = reference.name;
  if (!read.system.empty() && stated != read.system)
    throw InputError("'" + file + "': its member crs names " + read.system +
                     (stated.empty()
                          ? ", and GeoJSON is in WGS 84 (RFC 7946): state coordinates = \"" +
                                read.system + "\", or convert it by `ogr2ogr -t_srs EPSG:4326 " +
                                "out.geojson " + file + "`"
                          : ", and coordinates are " + stated));
  reference.system = kml || stated.empty() ? PolygonSystem::degrees : PolygonSystem::named;
  for (std::size_t k = 0; k < read.polygons.size(); ++k) {
    SurveyPolygon& polygon = read.polygons[k];
    if (polygon.name.empty() && !given.text("name").empty())
      polygon.name = given.text("name") +
                     (read.polygons.size() > 1 ? " " + std::to_string(k + 1) : std::string());
  }
  return std::move(read.polygons);
}

Value corners_of(const GroundPolygon& polygon) {
  Value list = Value::list();
  for (const Eigen::Vector2d& corner : polygon) {
    list.push_back(corner.x());
    list.push_back(corner.y());
  }
  return list;
}

Value to_value(const LocalPrism& prism) {
  Value value = Value::map(), holes = Value::list();
  value.set("name", prism.name);
  value.set("corners", corners_of(prism.outline));
  for (const GroundPolygon& polygon : prism.holes) {
    Value hole = Value::map();
    hole.set("corners", corners_of(polygon));
    holes.push_back(std::move(hole));
  }
  value.set("holes", std::move(holes));
  if (prism.low) value.set("low", *prism.low);
  if (prism.high) value.set("high", *prism.high);
  value.set("weight", prism.weight);
  return value;
}

std::optional<double> stated_number_of(const Parameters& given, const char* key) {
  return given.has(key) ? std::optional(given.number(key)) : std::nullopt;
}

// run:prisms{corners =, ...}: {{name =, corners =, holes =, low =, high =, weight =}, ...}, or nil
// and what is wrong.
int prisms_of_run(lua_State* state) {
  const MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, prisms_table(), "prisms");
  Value list = Value::list();
  try {
    PrismReference reference;
    reference.name = given.text("coordinates");
    reference.origin = run.origin;
    reference.heights = height_above_named(given.text("heights"));
    reference.ground_level = stated_number_of(given, "ground_level");
    for (SurveyPolygon& polygon : polygons_of(given, run, reference)) {
      if (!polygon.from) polygon.from = stated_number_of(given, "low");
      if (!polygon.to) polygon.to = stated_number_of(given, "high");
      if (!polygon.weight) polygon.weight = stated_number_of(given, "weight");
      list.push_back(to_value(local_prism(polygon, reference)));
    }
  } catch (const InputError& error) {
    lua_pushnil(state);
    push_text(state, error.what());
    return 2;
  }
  push_value(state, list);
  return 1;
}

}  // namespace

std::span<const Binding> prism_methods_of_run() {
  static const Binding methods[] = {
      {"prisms", &guarded<prisms_of_run>, "(polygons: @): table[]?, string?",
       "prisms over polygons on the ground, in the world frame: {name, corners, holes, low, high, "
       "weight}; or nil and what is wrong",
       &prisms_table}};
  return methods;
}

}  // namespace lapwing
