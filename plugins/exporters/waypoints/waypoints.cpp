// SPDX-License-Identifier: Apache-2.0
// A flight as a mission in text, which Mission Planner, QGroundControl and MAVSDK read: QGC WPL
// 110.
//
//   lapwing export out/hello/plan.json --format waypoints:autopilot=ardupilot -o hello.waypoints
#include <sstream>

#include "framework/core/error.h"
#include "framework/export/camera_track.h"
#include "framework/export/mission_items.h"
#include "framework/export/take_off_place.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

constexpr const char* kFirstLine = "QGC WPL 110\n";

std::string line_of(int number, const MissionItem& item) {
  std::string line = std::to_string(number) + (number == 0 ? "\t1\t" : "\t0\t") +
                     std::to_string(item.frame) + '\t' + std::to_string(item.command);
  for (std::size_t i = 0; i < 7; ++i)
    line += '\t' + fixed_number(item.params[i], i == 4 || i == 5 ? 8 : 4);
  return line + "\t1\n";
}

std::vector<MissionItem> items_in(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  std::vector<MissionItem> items;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    int number = 0, current = 0;
    MissionItem item;
    words >> number >> current >> item.frame >> item.command;
    for (double& p : item.params) words >> p;
    if (!words) throw InputError("waypoints: '" + line + "' is no item");
    items.push_back(item);
  }
  return items;
}

class Waypoints final : public Exporter {
 public:
  static constexpr PluginText kText{"waypoints", "1.0.0",
                                    "mission as text, QGC WPL 110 (.waypoints)",
                                    "https://mavlink.io/en/file_formats/"};
  static ParameterTable parameters() { return mission_parameters(); }
  explicit Waypoints(const Parameters& parameters) : options_(mission_file_options(parameters)) {}

  std::string file_extension() const override { return ".waypoints"; }
  bool shows_surroundings() const override { return true; }

  std::string write(const Plan& plan) const override {
    if (!states_certified(plan))
      throw InputError("waypoints: '" + plan.mission +
                       "' is not certified, and this format has no place to say so; qgc_plan has");
    const PlannedMission mission = mission_of(plan, options_, "waypoints");
    const EarthFrame frame(plan, std::nullopt, "waypoints");
    const double sea = home_above_sea(frame, mission.home, nullptr).value_or(0);
    std::string out = kFirstLine;
    out += line_of(0, {mav::kWaypoint,
                       mav::kGlobal,
                       {0, 0, 0, 0, mission.home.latitude_deg, mission.home.longitude_deg, sea}});
    int number = 0;
    for (const MissionItem& item : mission.items) out += line_of(++number, item);
    return out;
  }

  std::vector<std::string> losses(const Plan& plan, const std::string&) const override {
    PlannedMission mission = mission_of(plan, options_, "waypoints");
    home_above_sea(EarthFrame(plan, std::nullopt, "waypoints"), mission.home, &mission.said);
    if (!mission.fences.empty())
      mission.said.emplace_back("fences are not in this format; qgc_plan has them");
    if (!mission.rally_points.empty())
      mission.said.emplace_back("rally points are not in this format; qgc_plan has them");
    return mission.said;
  }

  std::optional<FlownFile> flown(const Plan& plan, const std::string& written) const override {
    std::vector<MissionItem> items = items_in(written);
    const auto home = items.at(0).params;
    items.erase(items.begin());
    const EarthFrame frame(plan, std::nullopt, "waypoints");
    FlownFile flown = flight_of(items, frame, {home[4], home[5], 0},
                                take_off_z(plan, options_.home_z), options_.ardupilot, plan);
    const PlannedMission mission = mission_of(plan, options_, "waypoints");
    flown.start = mission.start;
    flown.finish = mission.finish;
    return flown;
  }

 private:
  MissionFileOptions options_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Waypoints)
