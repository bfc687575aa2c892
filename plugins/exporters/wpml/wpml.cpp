// SPDX-License-Identifier: Apache-2.0
// A flight as a wayline mission of DJI: WPML in a .kmz file.
//
//   lapwing export out/hello/plan.json --format wpml:drone=m3e -o hello.kmz
#include <cmath>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/map_features.h"
#include "framework/export/route.h"
#include "framework/plugin/plugin.h"
#include "plugins/exporters/wpml/stored_zip.h"

namespace lapwing {
namespace {

constexpr double kLowest = -1500, kHighest = 1500;  // m above the take-off place
constexpr const char* kTemplate = "wpmz/template.kml";
constexpr const char* kWaylines = "wpmz/waylines.wpml";

struct Drone {
  const char* name;
  int number, payload;
};
constexpr Drone kDrones[] = {
    {"m3e", 77, 66}, {"m30", 67, 52}, {"m300", 60, 42}, {"m350", 89, 42}, {"m3d", 91, 80}};

std::string element(const std::string& name, const std::string& content) {
  return "<wpml:" + name + ">" + content + "</wpml:" + name + ">";
}

// The text of the next element of that name from `at` on, which moves behind it; "" where there is
// none before `end`.
std::string next_text(const std::string& text, const std::string& name, std::size_t& at,
                      std::size_t end) {
  const std::string open = "<" + name + ">";
  const std::size_t begin = text.find(open, at);
  if (begin >= end) return "";
  const std::size_t close = text.find("</" + name + ">", begin);
  if (close == std::string::npos) throw InputError("wpml: '" + name + "' has no end");
  at = close;
  return text.substr(begin + open.size(), close - begin - open.size());
}

double number_of(const std::string& text, const std::string& name, std::size_t from,
                 std::size_t end) {
  return std::strtod(next_text(text, name, from, end).c_str(), nullptr);
}

class Wpml final : public Exporter {
 public:
  static constexpr PluginText kText{"wpml", "1.0.0", "wayline mission of DJI, WPML (.kmz)",
                                    "https://github.com/dji-sdk/Cloud-API-Doc"};
  static ParameterTable parameters() {
    ParameterTable table = route_parameters(200);
    table.choice("drone", "m3e", {"m3e", "m30", "m300", "m350", "m3d"}, "drone of the mission")
        .optional_number("payload", "", "number of the camera; absent: that of the drone")
        .choice("finish", "goHome", {"goHome", "noAction", "autoLand", "gotoFirstWaypoint"},
                "action after the last waypoint")
        .number("take_off_height", 20, "m", "height to which the drone climbs first",
                between(1.2, 1500));
    return table;
  }
  explicit Wpml(const Parameters& parameters)
      : options_(route_options(parameters)),
        finish_(parameters.text("finish")),
        climb_(parameters.number("take_off_height")) {
    for (const Drone& drone : kDrones)
      if (parameters.text("drone") == drone.name) drone_ = drone;
    if (parameters.has("payload")) drone_.payload = static_cast<int>(parameters.number("payload"));
  }

  std::string file_extension() const override { return ".kmz"; }
  bool shows_surroundings() const override { return true; }

  std::string write(const Plan& plan) const override {
    const PlannedRoute route = route_of(plan, options_, "wpml", kLowest, kHighest);
    check_climb(plan);
    const EarthFrame frame(plan, std::nullopt, "wpml");
    std::string placemarks;
    for (std::size_t k = 0; k < route.points.size(); ++k)
      placemarks += placemark(plan, route, frame, k);
    return wpml_file::zip_bytes({{kTemplate, document(plan, placemarks, true)},
                                 {kWaylines, document(plan, placemarks, false)}});
  }

  std::vector<std::string> losses(const Plan& plan, const std::string&) const override {
    return route_of(plan, options_, "wpml", kLowest, kHighest).said;
  }

  std::optional<FlownFile> flown(const Plan& plan, const std::string& written) const override {
    const PlannedRoute planned = route_of(plan, options_, "wpml", kLowest, kHighest);
    const EarthFrame frame(plan, std::nullopt, "wpml");
    const std::string text = wpml_file::file_in_zip(written, kWaylines);
    ReadRoute route;
    double pitch = 0;
    for (std::size_t at = 0; (at = text.find("<Placemark>", at)) != std::string::npos;) {
      const std::size_t end = text.find("</Placemark>", at);
      std::size_t from = at;
      const std::string place = next_text(text, "coordinates", from, end);
      FlownPoint point;
      char* rest = nullptr;
      const double longitude = std::strtod(place.c_str(), &rest);
      const double latitude = std::strtod(rest + 1, nullptr);
      point.position =
          frame.local({latitude, longitude,
                       planned.home.height + number_of(text, "wpml:executeHeight", at, end)});
      point.speed = number_of(text, "wpml:waypointSpeed", at, end);
      point.yaw = radians(90 - number_of(text, "wpml:waypointHeadingAngle", at, end));
      point.radius = number_of(text, "wpml:waypointTurnDampingDist", at, end);
      std::vector<RouteImage> images;
      point.pitch = pitch;
      read_actions(text, at, end, point, pitch, images);
      route.points.push_back(point);
      route.images.push_back(images);
      at = end;
    }
    FlownFile flown = fly_route(route, plan);
    flown.start = planned.start;
    flown.finish = planned.finish;
    return flown;
  }

 private:
  // The drone climbs so high before it goes to its first waypoint, wherever that is.
  void check_climb(const Plan& plan) const {
    if (!plan.home || !plan.home->max_height || climb_ <= *plan.home->max_height) return;
    throw InputError("wpml: take_off_height=" + plain_number(climb_) +
                     " m: the plan flies at most " + plain_number(*plan.home->max_height) +
                     " m above home (`home.max_height`); expected no more than that");
  }

  // What the actions of a waypoint do. `pitch` is that which is ordered for the next waypoint.
  static void read_actions(const std::string& text, std::size_t at, std::size_t end,
                           FlownPoint& point, double& pitch, std::vector<RouteImage>& images) {
    RouteImage now{*point.yaw, point.pitch};
    bool first = true;
    while (true) {
      const std::string name = next_text(text, "wpml:actionActuatorFunc", at, end);
      if (name.empty()) return;
      const std::size_t stop = std::min(end, text.find("</wpml:action>", at));
      if (name == "hover") point.hold += number_of(text, "wpml:hoverTime", at, stop);
      if (name == "gimbalRotate") {
        now.pitch = radians(number_of(text, "wpml:gimbalPitchRotateAngle", at, stop));
        if (first) point.pitch = now.pitch;
        pitch = now.pitch;
      }
      if (name == "rotateYaw")
        now.yaw = radians(90 - number_of(text, "wpml:aircraftHeading", at, stop));
      if (name == "takePhoto") images.push_back(now);
      if (name == "gimbalEvenlyRotate")
        pitch = radians(number_of(text, "wpml:gimbalPitchRotateAngle", at, stop));
      first = false;
    }
  }

  std::string document(const Plan& plan, const std::string& placemarks, bool editable) const {
    std::string out =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<kml xmlns=\"http://www.opengis.net/kml/2.2\" "
        "xmlns:wpml=\"http://www.dji.com/wpmz/1.0.2\">\n<Document>\n";
    if (editable)
      out +=
          element("author", states_certified(plan) ? "Lapwing" : "Lapwing (not certified)") + "\n";
    out += "<wpml:missionConfig>" + element("flyToWaylineMode", "safely") +
           element("finishAction", finish_) + element("exitOnRCLost", "executeLostAction") +
           element("executeRCLostAction", "goBack") +
           element("takeOffSecurityHeight", fixed_number(climb_, 1)) +
           element("globalTransitionalSpeed", "5") +
           element("droneInfo", element("droneEnumValue", std::to_string(drone_.number)) +
                                    element("droneSubEnumValue", "0")) +
           element("payloadInfo", element("payloadEnumValue", std::to_string(drone_.payload)) +
                                      element("payloadPositionIndex", "0")) +
           "</wpml:missionConfig>\n<Folder>";
    if (editable)
      out +=
          element("templateType", "waypoint") +
          element("waylineCoordinateSysParam", element("coordinateMode", "WGS84") +
                                                   element("heightMode", "relativeToStartPoint"));
    out += element("templateId", "0");
    if (!editable)
      out += element("executeHeightMode", "relativeToStartPoint") + element("waylineId", "0");
    return out + element("autoFlightSpeed", "5") + "\n" + placemarks +
           "</Folder>\n</Document>\n</kml>\n";
  }

  static std::string gimbal_params(double pitch) {
    return element("gimbalHeadingYawBase", "north") + element("gimbalRotateMode", "absoluteAngle") +
           element("gimbalPitchRotateEnable", "1") +
           element("gimbalPitchRotateAngle", fixed_number(degrees(pitch), 2)) +
           element("gimbalRollRotateEnable", "0") + element("gimbalRollRotateAngle", "0") +
           element("gimbalYawRotateEnable", "0") + element("gimbalYawRotateAngle", "0") +
           element("gimbalRotateTimeEnable", "0") + element("gimbalRotateTime", "0") +
           element("payloadPositionIndex", "0");
  }

  static std::string action(int number, const std::string& name, const std::string& parameters) {
    return element("action", element("actionId", std::to_string(number)) +
                                 element("actionActuatorFunc", name) +
                                 element("actionActuatorFuncParam", parameters));
  }

  static std::string group(std::size_t number, std::size_t first, std::size_t last,
                           const std::string& trigger, const std::string& actions) {
    return element("actionGroup",
                   element("actionGroupId", std::to_string(number)) +
                       element("actionGroupStartIndex", std::to_string(first)) +
                       element("actionGroupEndIndex", std::to_string(last)) +
                       element("actionGroupMode", "sequence") +
                       element("actionTrigger", element("actionTriggerType", trigger)) + actions);
  }

  // In [-180, 180], as the format has headings.
  static std::string heading_text(double yaw) {
    const double heading = compass_deg(yaw);
    return fixed_number(heading > 180 ? heading - 360 : heading, 2);
  }

  static std::string actions_at(const Plan& plan, const PlannedRoute& route, std::size_t k) {
    const RoutePoint& point = route.points[k];
    std::string actions;
    int number = 0;
    const auto add = [&](const char* name, const std::string& parameters) {
      actions += action(number++, name, parameters);
    };
    const std::string camera = element("payloadPositionIndex", "0");
    if (k == 0) add("gimbalRotate", gimbal_params(point.pitch));
    if (!plan.task.scan && k == 0) add("startRecord", camera);
    if (point.at.hold >= 0.01) add("hover", element("hoverTime", fixed_number(point.at.hold, 2)));
    for (std::size_t i = 0; i < point.images.size(); ++i) {
      if (i > 0) {
        add("rotateYaw", element("aircraftHeading", heading_text(point.images[i].yaw)) +
                             element("aircraftPathMode", "clockwise"));
        add("gimbalRotate", gimbal_params(point.images[i].pitch));
      }
      add("takePhoto", element("fileSuffix", "view") + camera);
    }
    if (!plan.task.scan && k + 1 == route.points.size()) add("stopRecord", camera);
    std::string groups;
    if (!actions.empty()) groups += group(2 * k, k, k, "reachPoint", actions);
    if (k + 1 < route.points.size())
      groups += group(2 * k + 1, k, k + 1, "betweenAdjacentPoints",
                      action(0, "gimbalEvenlyRotate",
                             element("gimbalPitchRotateAngle",
                                     fixed_number(degrees(route.points[k + 1].pitch), 2)) +
                                 camera));
    return groups;
  }

  static std::string placemark(const Plan& plan, const PlannedRoute& route, const EarthFrame& frame,
                               std::size_t k) {
    const RoutePoint& point = route.points[k];
    const EarthPoint at = frame.at(point.at.position);
    const bool stops =
        k == 0 || k + 1 == route.points.size() || point.at.hold > 0 || point.images.size() > 1;
    const std::string height = fixed_number(route.height(at), 2);
    return "<Placemark><Point><coordinates>" + fixed_number(at.longitude_deg, 8) + ',' +
           fixed_number(at.latitude_deg, 8) + "</coordinates></Point>" +
           element("index", std::to_string(k)) + element("executeHeight", height) +
           element("ellipsoidHeight", height) + element("height", height) +
           element("waypointSpeed", fixed_number(std::max(0.1, point.at.speed), 2)) +
           element("waypointHeadingParam",
                   element("waypointHeadingMode", "smoothTransition") +
                       element("waypointHeadingAngle", heading_text(point.yaw)) +
                       element("waypointPoiPoint", "0.000000,0.000000,0.000000") +
                       element("waypointHeadingPathMode", "followBadArc")) +
           element("waypointTurnParam",
                   element("waypointTurnMode",
                           stops ? "toPointAndStopWithDiscontinuityCurvature" : "coordinateTurn") +
                       element("waypointTurnDampingDist",
                               fixed_number(stops ? 0 : point.at.radius, 2))) +
           element("useStraightLine", "1") + actions_at(plan, route, k) + "</Placemark>\n";
  }

  RouteOptions options_;
  std::string finish_;
  double climb_;
  Drone drone_ = kDrones[0];
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Wpml)
