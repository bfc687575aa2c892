// SPDX-License-Identifier: Apache-2.0
// A flight as GeoJSON: path, places and zones as features with properties.
//
//   lapwing export out/hello/plan.json --format geojson:heights=ground -o hello.geojson
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/earth_frame.h"
#include "framework/export/exporter.h"
#include "framework/export/map_features.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

// Rounded to 0.1 mm: longer numbers tell nothing.
Value position(const EarthPoint& point) {
  return Value(Value::List{std::round(point.longitude_deg * 1e9) / 1e9,
                           std::round(point.latitude_deg * 1e9) / 1e9,
                           std::round(point.height * 1e4) / 1e4});
}

Value feature(const char* type, Value coordinates, Value properties) {
  Value geometry = Value::map(), made = Value::map();
  geometry.set("type", type);
  geometry.set("coordinates", std::move(coordinates));
  made.set("type", "Feature");
  made.set("geometry", std::move(geometry));
  made.set("properties", std::move(properties));
  return made;
}

// The standard asks for lines and outlines that are cut at the date line (RFC 7946, 3.1.9): others
// are drawn around the earth.
void expect_no_date_line(const Value& line, const std::string& what) {
  const auto& positions = line.as_list();
  for (std::size_t i = 1; i < positions.size(); ++i) {
    const double from = positions[i - 1].as_list()[0].as_number();
    const double to = positions[i].as_list()[0].as_number();
    if (std::abs(to - from) > 180)
      throw InputError("geojson: " + what + " crosses the date line, from longitude " +
                       plain_number(from, 10) + " to " + plain_number(to, 10) +
                       " deg; programs would draw it around the earth (RFC 7946, 3.1.9). Expected "
                       "an origin whose flight and zones lie on one side");
  }
}

double heading_of(double yaw) {
  const double heading = std::fmod(90 - degrees(yaw), 360);
  return heading < 0 ? heading + 360 : heading;
}

class Geojson final : public Exporter {
 public:
  static constexpr PluginText kText{
      "geojson", "1.0.0", "path, places and zones as GeoJSON features (.geojson)", "RFC 7946"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .number("rate", 10, "1/s", "points of the path per second", between(0.1, 1000))
        .choice("heights", "ellipsoid", {"ellipsoid", "sea", "ground"},
                "reference of heights; the standard requires the ellipsoid");
  }
  explicit Geojson(const Parameters& parameters)
      : rate_(parameters.number("rate")), heights_(*height_of_named(parameters.text("heights"))) {}

  std::string file_extension() const override { return ".geojson"; }

  std::string write(const Plan& plan) const override {
    const EarthFrame frame(plan, heights_, "geojson");
    Value features = Value::list(), collection = Value::map();
    features.push_back(path(plan, frame));
    for (const MapPoint& point : map_points(plan)) features.push_back(place(point, frame));
    for (const MapZone& zone : map_zones(plan)) features.push_back(outline(zone, frame));
    collection.set("type", "FeatureCollection");
    collection.set("name", as_utf8(stated_name(plan)));
    collection.set("certified", states_certified(plan));
    collection.set("heights_above", EarthFrame::in_words(heights_));
    collection.set("features", std::move(features));
    return to_json(collection) + "\n";
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    const EarthFrame frame(plan, heights_, "geojson");
    const Value document = from_json(written, "geojson");
    const Value& line = document.at("features").as_list().front();
    std::vector<double> times;
    for (const Value& time : line.at("properties").at("times").as_list())
      times.push_back(time.as_number());
    std::vector<EarthPoint> points;
    std::vector<Eigen::Vector3d> places;
    for (const Value& p : line.at("geometry").at("coordinates").as_list()) {
      points.push_back(
          {p.as_list()[1].as_number(), p.as_list()[0].as_number(), p.as_list()[2].as_number()});
      places.push_back(frame.local(points.back()));
    }
    const PathDeviation worst = deviation_of_path(plan, times, places);
    std::vector<std::string> said{
        frame.sentence(points),
        "joined by straight lines, the path is at most " + plain_number(100 * worst.distance, 3) +
            " cm from the plan (at " + plain_number(worst.time, 4) + " s)",
        "headings of the vehicle, and obstacles that are no zones are not in the file"};
    if (heights_ != HeightOf::ellipsoid)
      said.emplace_back("heights are above " + EarthFrame::in_words(heights_) +
                        "; programs take those of GeoJSON as above the ellipsoid");
    return said;
  }

 private:
  Value path(const Plan& plan, const EarthFrame& frame) const {
    const std::vector<double> times = frame_times(plan.trajectory, rate_, "geojson");
    Value line = Value::list(), stated = Value::list(), properties = Value::map();
    for (const Eigen::Vector3d& p : path_at(plan, times, "geojson"))
      line.push_back(position(frame.at(p)));
    expect_no_date_line(line, "the path");
    for (const double time : times) stated.push_back(time);
    properties.set("kind", "path");
    properties.set("times", std::move(stated));
    return feature("LineString", std::move(line), std::move(properties));
  }

  static Value place(const MapPoint& point, const EarthFrame& frame) {
    Value properties = Value::map();
    properties.set("kind", point.kind);
    properties.set("name", as_utf8(point.name));
    if (point.time) properties.set("time", *point.time);
    if (point.yaw) properties.set("heading_deg", heading_of(*point.yaw));
    if (point.pitch) properties.set("pitch_deg", degrees(*point.pitch));
    return feature("Point", position(frame.at(point.position)), std::move(properties));
  }

  static Value outline(const MapZone& zone, const EarthFrame& frame) {
    Value ring = Value::list(), rings = Value::list(), properties = Value::map();
    const double level = zone.floor.value_or(0);
    for (std::size_t i = 0; i <= zone.corners.size(); ++i) {
      const Eigen::Vector2d& c = zone.corners[i % zone.corners.size()];
      ring.push_back(position(frame.at({c.x(), c.y(), level})));
    }
    expect_no_date_line(ring, zone.name);
    rings.push_back(std::move(ring));
    properties.set("kind", zone.keep_inside ? "flight zone" : "zone");
    properties.set("name", as_utf8(zone.name));
    const auto height = [&](double z) { return frame.at({0, 0, z}).height; };
    if (zone.floor) properties.set("floor", height(*zone.floor));
    if (zone.ceiling) properties.set("ceiling", height(*zone.ceiling));
    return feature("Polygon", std::move(rings), std::move(properties));
  }

  double rate_;
  HeightOf heights_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Geojson)
