// SPDX-License-Identifier: Apache-2.0
// A flight as a mission of Litchi: a row a waypoint.
//
//   lapwing export out/hello/plan.json --format litchi:tolerance=0.3 -o hello.csv
#include <cmath>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/route.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

constexpr int kActions = 15;
constexpr double kLowest = -200, kHighest = 500;  // m above the take-off place
// Numbers of actions.
constexpr int kStay = 0, kPhotograph = 1, kRecord = 2, kStop = 3, kRotate = 4, kTilt = 5;

std::string header() {
  std::string text =
      "latitude,longitude,altitude(m),heading(deg),curvesize(m),rotationdir,gimbalmode,"
      "gimbalpitchangle";
  for (int i = 1; i <= kActions; ++i)
    text += ",actiontype" + std::to_string(i) + ",actionparam" + std::to_string(i);
  return text +
         ",altitudemode,speed(m/s),poi_latitude,poi_longitude,poi_altitude(m),poi_altitudemode,"
         "photo_timeinterval,photo_distinterval\n";
}

std::vector<double> numbers_in(const std::string& line) {
  std::vector<double> numbers;
  std::istringstream words(line);
  for (std::string word; std::getline(words, word, ',');)
    numbers.push_back(std::strtod(word.c_str(), nullptr));
  return numbers;
}

class Litchi final : public Exporter {
 public:
  static constexpr PluginText kText{"litchi", "1.0.0", "mission of Litchi for drones of DJI (.csv)",
                                    "https://www.litchiutilities.com/docs/litchiCsv.php"};
  static ParameterTable parameters() { return route_parameters(99); }
  explicit Litchi(const Parameters& parameters) : options_(route_options(parameters)) {}

  std::string file_extension() const override { return ".csv"; }
  bool shows_surroundings() const override { return true; }

  std::string write(const Plan& plan) const override {
    if (!states_certified(plan))
      throw InputError("litchi: '" + plan.mission +
                       "' is not certified, and this format has no place to say so; wpml has");
    const PlannedRoute route = route_of(plan, options_, "litchi", kLowest, kHighest);
    const EarthFrame frame(plan, std::nullopt, "litchi");
    std::string out = header();
    for (std::size_t k = 0; k < route.points.size(); ++k) out += row(plan, route, frame, k);
    return out;
  }

  std::vector<std::string> losses(const Plan& plan, const std::string&) const override {
    std::vector<std::string> said = route_of(plan, options_, "litchi", kLowest, kHighest).said;
    said.emplace_back(
        "Litchi keeps these outside of the file, so set them there: heading mode Custom (WD), path "
        "mode Curved Turns, finish action");
    return said;
  }

  std::optional<FlownFile> flown(const Plan& plan, const std::string& written) const override {
    const PlannedRoute planned = route_of(plan, options_, "litchi", kLowest, kHighest);
    const EarthFrame frame(plan, std::nullopt, "litchi");
    ReadRoute route;
    std::istringstream lines(written);
    std::string line;
    std::getline(lines, line);
    double speed = 0;
    while (std::getline(lines, line)) {
      const std::vector<double> n = numbers_in(line);
      if (n.size() != 46) throw InputError("litchi: '" + line + "' is no waypoint");
      FlownPoint point;
      point.position = frame.local({n[0], n[1], planned.home.height + n[2]});
      point.yaw = radians(90 - n[3]);
      point.radius = n[4];
      point.pitch = radians(n[7]);
      point.speed = speed;
      speed = n[39];
      std::vector<RouteImage> images;
      RouteImage now{*point.yaw, point.pitch};
      for (std::size_t i = 8; i < 38; i += 2) {
        if (n[i] == kStay) point.hold += n[i + 1] / 1000;
        if (n[i] == kRotate) now.yaw = radians(90 - n[i + 1]);
        if (n[i] == kTilt) now.pitch = radians(n[i + 1]);
        if (n[i] == kPhotograph) images.push_back(now);
      }
      route.points.push_back(point);
      route.images.push_back(images);
    }
    FlownFile flown = fly_route(route, plan);
    flown.start = planned.start;
    flown.finish = planned.finish;
    return flown;
  }

 private:
  static std::vector<std::pair<int, double>> actions_at(const Plan& plan, const PlannedRoute& route,
                                                        std::size_t k) {
    const RoutePoint& point = route.points[k];
    std::vector<std::pair<int, double>> actions;
    const bool films = !plan.task.scan;
    if (films && k == 0) actions.emplace_back(kRecord, 0);
    if (point.at.hold >= 0.001) actions.emplace_back(kStay, std::round(1000 * point.at.hold));
    for (std::size_t i = 0; i < point.images.size(); ++i) {
      if (i > 0) {
        actions.emplace_back(kRotate, compass_deg(point.images[i].yaw));
        actions.emplace_back(kTilt, degrees(point.images[i].pitch));
      }
      actions.emplace_back(kPhotograph, 0);
    }
    if (films && k + 1 == route.points.size()) actions.emplace_back(kStop, 0);
    if (actions.size() > kActions)
      throw InputError("litchi: " + std::to_string(actions.size()) +
                       " actions at one waypoint, and the format holds 15: " +
                       std::to_string(point.images.size()) + " images are taken in one place");
    return actions;
  }

  static std::string row(const Plan& plan, const PlannedRoute& route, const EarthFrame& frame,
                         std::size_t k) {
    const RoutePoint& point = route.points[k];
    const EarthPoint at = frame.at(point.at.position);
    const bool stops = point.at.hold > 0 || point.images.size() > 1;
    std::string out = fixed_number(at.latitude_deg, 8) + ',' + fixed_number(at.longitude_deg, 8) +
                      ',' + fixed_number(route.height(at), 2) + ',' +
                      fixed_number(compass_deg(point.yaw), 2) + ',' +
                      fixed_number(stops ? 0 : point.at.radius, 2) + ",0,2," +
                      fixed_number(degrees(point.pitch), 2);
    const auto actions = actions_at(plan, route, k);
    for (std::size_t i = 0; i < kActions; ++i)
      out += i < actions.size()
                 ? ',' + std::to_string(actions[i].first) + ',' + fixed_number(actions[i].second, 2)
                 : ",-1,0";
    // The speed is that of the way to the next waypoint.
    const double speed = route.points[std::min(k + 1, route.points.size() - 1)].at.speed;
    return out + ",0," + fixed_number(speed, 2) + ",0,0,0,0,-1,-1\n";
  }

  RouteOptions options_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Litchi)
