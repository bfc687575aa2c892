// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/survey/polygon_builder.h"

namespace lapwing {
namespace {

const Value* member(const Value& object, const char* key) {
  const Value* value = object.is_map() ? object.find(key) : nullptr;
  return value && !value->is_null() ? value : nullptr;
}

std::string text_member(const Value& object, const char* key) {
  const Value* value = member(object, key);
  return value && value->is_text() ? value->as_text() : "";
}

class GeoJson {
 public:
  GeoJson(const std::string& named, const std::string& what) : named_(named), what_(what) {}

  PolygonFile read(const Value& root) {
    if (!root.is_map())
      throw InputError(what_ + ": expected a GeoJSON object with a member 'type'");
    read_system(root);
    read_object(root);
    require_polygons(file_, named_, what_, names_);
    return std::move(file_);
  }

 private:
  // Files of 2008 could name a system; RFC 7946 knows WGS 84 alone.
  void read_system(const Value& root) {
    const Value* crs = member(root, "crs");
    if (!crs) return;
    const Value* properties = member(*crs, "properties");
    std::string name = properties ? text_member(*properties, "name") : "";
    if (text_member(*crs, "type") != "name" || name.empty())
      throw InputError(what_ +
                       ": its member crs names no reference system: remove it where the "
                       "coordinates are longitude and latitude of WGS 84");
    // urn:ogc:def:crs:EPSG::28992, urn:ogc:def:crs:OGC:1.3:CRS84
    if (name.starts_with("urn:ogc:def:crs:")) {
      const std::string rest = name.substr(16);
      name = rest.substr(0, rest.find(':')) + ":" + rest.substr(rest.rfind(':') + 1);
    }
    if (name == "OGC:CRS84" || name == "EPSG:4326") return;
    file_.system = name;
  }

  void read_object(const Value& object) {
    const std::string type = text_member(object, "type");
    if (type == "FeatureCollection") {
      const Value* features = member(object, "features");
      if (!features || !features->is_list())
        throw InputError(what_ + ": a FeatureCollection has a list 'features'");
      for (const Value& feature : features->as_list()) {
        ++number_;
        if (text_member(feature, "type") != "Feature")
          throw InputError(what_ + ": feature " + std::to_string(number_) +
                           ": expected an object of type 'Feature'");
        read_feature(feature);
      }
    } else if (type == "Feature") {
      number_ = 1;
      read_feature(object);
    } else {
      SurveyPolygon polygon;
      polygon.place = what_;
      if (named_.empty()) read_geometry(object, polygon);
    }
  }

  void read_feature(const Value& feature) {
    SurveyPolygon polygon;
    const Value* properties = member(feature, "properties");
    if (properties) polygon.name = text_member(*properties, "name");
    polygon.place = what_ + ": feature " + std::to_string(number_) +
                    (polygon.name.empty() ? "" : " '" + polygon.name + "'");
    if (!polygon.name.empty()) names_.push_back(polygon.name);
    if (!named_.empty() && polygon.name != named_) return;
    if (properties && properties->is_map())
      for (const auto& [key, value] : properties->as_map()) {
        if (!is_polygon_property(key) || value.is_null()) continue;
        if (!value.is_number())
          throw InputError(polygon.place + ": property '" + key + "': expected a number, got " +
                           value.describe_type());
        set_property(polygon, key, value.as_number());
      }
    const Value* geometry = member(feature, "geometry");
    if (!geometry) throw InputError(polygon.place + ": it has no geometry");
    read_geometry(*geometry, polygon);
  }

  void read_geometry(const Value& geometry, const SurveyPolygon& about) {
    const std::string type = text_member(geometry, "type");
    const Value* coordinates = member(geometry, "coordinates");
    if (type != "Polygon" && type != "MultiPolygon")
      throw InputError(about.place + ": expected a Polygon or a MultiPolygon, got " +
                       (type.empty() ? "no type" : "'" + type + "'") +
                       "; `named` takes what has one name from a file with other things");
    if (!coordinates || !coordinates->is_list() || coordinates->as_list().empty())
      throw InputError(about.place + ": expected a list 'coordinates' that is not empty");
    if (type == "Polygon") return add(*coordinates, about);
    for (const Value& part : coordinates->as_list()) add(part, about);
  }

  void add(const Value& rings, const SurveyPolygon& about) {
    if (!rings.is_list() || rings.as_list().empty())
      throw InputError(about.place + ": a polygon is a list of rings, the outline first");
    SurveyPolygon polygon = about;
    std::size_t number = 0;
    for (const Value& ring : rings.as_list()) {
      const std::string place =
          number == 0 ? about.place : about.place + ", hole " + std::to_string(number);
      auto corners = open_ring(positions_of(ring, place), place);
      if (number++ == 0)
        polygon.outline = std::move(corners);
      else
        polygon.holes.push_back(std::move(corners));
    }
    file_.polygons.push_back(std::move(polygon));
  }

  static std::vector<Eigen::Vector2d> positions_of(const Value& ring, const std::string& place) {
    if (!ring.is_list()) throw InputError(place + ": a ring is a list of positions");
    std::vector<Eigen::Vector2d> positions;
    for (const Value& position : ring.as_list()) {
      const std::size_t number = positions.size() + 1;
      const bool sound =
          position.is_list() && (position.as_list().size() == 2 || position.as_list().size() == 3);
      if (!sound)
        throw InputError(place + ": position " + std::to_string(number) +
                         ": expected a list of longitude and latitude");
      for (const Value& figure : position.as_list())
        if (!figure.is_number() || !std::isfinite(figure.as_number()))
          throw InputError(place + ": position " + std::to_string(number) + ": expected numbers");
      const Value::List& figures = position.as_list();
      if (figures.size() == 3 && figures[2].as_number() != 0)
        refuse_heights(place, figures[2].as_number(), number,
                       "which RFC 7946 takes above the ellipsoid and others above the sea or the "
                       "ground");
      positions.emplace_back(figures[0].as_number(), figures[1].as_number());
    }
    return positions;
  }

  const std::string& named_;
  const std::string& what_;
  PolygonFile file_;
  std::vector<std::string> names_;  // of features
  int number_ = 0;                  // of the feature
};

}  // namespace

PolygonFile read_geojson(std::string_view text, const std::string& named, const std::string& what) {
  return GeoJson(named, what).read(from_json(std::string(text), what));
}

}  // namespace lapwing
