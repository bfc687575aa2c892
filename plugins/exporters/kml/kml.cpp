// SPDX-License-Identifier: Apache-2.0
// A flight as KML: its path, what the flight is for, and zones, with heights.
//
//   lapwing export out/hello/plan.json --format kml:rate=5 -o hello.kml --origin 46.5,6.6,0,ground
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/markup.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/earth_frame.h"
#include "framework/export/exporter.h"
#include "framework/export/map_features.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

constexpr int kDegrees = 9, kMetres = 4;  // decimals: 0.1 mm

std::string coordinates(const EarthPoint& point) {
  return fixed_number(point.longitude_deg, kDegrees) + ',' +
         fixed_number(point.latitude_deg, kDegrees) + ',' + fixed_number(point.height, kMetres);
}

// Of the placemark "path", as a map program reads them.
std::vector<EarthPoint> path_in(const std::string& text) {
  std::vector<EarthPoint> points;
  std::size_t at = text.find("<coordinates>", text.find("<LineString>"));
  if (at == std::string::npos) return points;
  at += 13;
  const char* cursor = text.c_str() + at;
  while (true) {
    char* end = nullptr;
    EarthPoint point;
    point.longitude_deg = std::strtod(cursor, &end);
    if (end == cursor) return points;
    point.latitude_deg = std::strtod(end + 1, &end);
    point.height = std::strtod(end + 1, &end);
    points.push_back(point);
    cursor = end;
  }
}

class Kml final : public Exporter {
 public:
  static constexpr PluginText kText{"kml", "1.0.0", "path, views and zones for map programs (.kml)",
                                    "https://developers.google.com/kml/documentation/kmlreference"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .number("rate", 10, "1/s", "points of the path per second", between(0.1, 1000))
        .choice("heights", "auto", {"auto", "sea", "ground"},
                "reference of heights; auto: ground for an origin above the ground, otherwise sea");
  }
  explicit Kml(const Parameters& parameters)
      : rate_(parameters.number("rate")), heights_(parameters.text("heights")) {}

  std::string file_extension() const override { return ".kml"; }

  std::string write(const Plan& plan) const override {
    const EarthFrame frame = frame_of(plan);
    std::string path;
    for (const Eigen::Vector3d& p :
         path_at(plan, frame_times(plan.trajectory, rate_, "kml"), "kml"))
      path += coordinates(frame.at(p)) + '\n';
    std::string out =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>" +
        markup_text(stated_name(plan)) + "</name>\n<description>" +
        markup_text("Planned by Lapwing. Heights in m above " +
                    EarthFrame::in_words(frame.heights())) +
        "</description>\n<Style id=\"path\"><LineStyle><color>ff00a5ff</color><width>3</width>"
        "</LineStyle></Style>\n<Placemark><name>path</name><styleUrl>#path</styleUrl>"
        "<LineString>" +
        mode(frame) + "<coordinates>\n" + path + "</coordinates></LineString></Placemark>\n";
    for (const MapPoint& point : map_points(plan)) add_point(out, frame, point);
    for (const MapZone& zone : map_zones(plan)) add_zone(out, frame, zone);
    return out + "</Document>\n</kml>\n";
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    const EarthFrame frame = frame_of(plan);
    const std::vector<EarthPoint> points = path_in(written);
    std::vector<Eigen::Vector3d> places;
    for (const EarthPoint& point : points) places.push_back(frame.local(point));
    const PathDeviation worst =
        deviation_of_path(plan, frame_times(plan.trajectory, rate_, "kml"), places);
    std::vector<std::string> said{
        frame.sentence(points),
        "joined by straight lines, the path is at most " + plain_number(100 * worst.distance, 3) +
            " cm from the plan (at " + plain_number(worst.time, 4) + " s)",
        "times, headings of the vehicle, and obstacles that are no zones are not in the file"};
    if (frame.heights() == HeightOf::ground)
      said.emplace_back(
          "heights are above the ground at the origin; map programs take them as above "
          "the ground below each point");
    return said;
  }

 private:
  EarthFrame frame_of(const Plan& plan) const {
    const bool ground =
        heights_ == "ground" || (heights_ == "auto" && plan.geodetic_origin &&
                                 plan.geodetic_origin->height_of == HeightOf::ground);
    return EarthFrame(plan, ground ? HeightOf::ground : HeightOf::sea, "kml");
  }

  static std::string mode(const EarthFrame& frame) {
    return std::string("<altitudeMode>") +
           (frame.heights() == HeightOf::ground ? "relativeToGround" : "absolute") +
           "</altitudeMode>";
  }

  static void add_point(std::string& out, const EarthFrame& frame, const MapPoint& point) {
    const EarthPoint at = frame.at(point.position);
    out += "<Placemark><name>" + markup_text(point.name) + "</name>";
    if (point.time)
      out += "<description>" + plain_number(*point.time, 6) + " s after the start</description>";
    if (point.yaw && point.pitch) {
      double heading = std::fmod(90 - degrees(*point.yaw), 360);
      if (heading < 0) heading += 360;
      out += "<Camera><longitude>" + fixed_number(at.longitude_deg, kDegrees) +
             "</longitude><latitude>" + fixed_number(at.latitude_deg, kDegrees) +
             "</latitude><altitude>" + fixed_number(at.height, kMetres) + "</altitude><heading>" +
             fixed_number(heading, 4) + "</heading><tilt>" +
             fixed_number(90 + degrees(*point.pitch), 4) + "</tilt><roll>0</roll>" + mode(frame) +
             "</Camera>";
    }
    out += "<Point>" + mode(frame) + "<coordinates>" + coordinates(at) +
           "</coordinates></Point></Placemark>\n";
  }

  // At its ceiling, or else at its floor, with walls down to the ground where it has no floor.
  static void add_zone(std::string& out, const EarthFrame& frame, const MapZone& zone) {
    const double level = zone.ceiling.value_or(zone.floor.value_or(0));
    out += "<Placemark><name>" + markup_text(zone.name) + "</name><description>" +
           (zone.keep_inside ? "not to be left" : "closed to flight");
    if (zone.floor) out += ", from z = " + plain_number(*zone.floor) + " m";
    if (zone.ceiling) out += ", to z = " + plain_number(*zone.ceiling) + " m";
    out += "</description><Polygon><extrude>" + std::string(zone.floor ? "0" : "1") + "</extrude>" +
           mode(frame) + "<outerBoundaryIs><LinearRing><coordinates>\n";
    for (std::size_t i = 0; i <= zone.corners.size(); ++i) {
      const Eigen::Vector2d& c = zone.corners[i % zone.corners.size()];
      out += coordinates(frame.at({c.x(), c.y(), level})) + '\n';
    }
    out += "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>\n";
  }

  double rate_;
  std::string heights_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Kml)
