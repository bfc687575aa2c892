// SPDX-License-Identifier: Apache-2.0
// A flight as a plan file of QGroundControl: mission and fence.
//
//   lapwing export out/hello/plan.json --format qgc_plan:tolerance=0.1 -o hello.plan
#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/export/camera_track.h"
#include "framework/export/mission_items.h"
#include "framework/export/take_off_place.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

constexpr int kPx4 = 12, kArduPilot = 3;  // MAV_AUTOPILOT
constexpr int kQuadrotor = 2;             // MAV_TYPE
constexpr int kAboveHome = 1;             // of QGroundControl's altitude modes

Value made(std::initializer_list<std::pair<const char*, Value>> entries) {
  Value value = Value::map();
  for (const auto& [key, entry] : entries) value.set(key, entry);
  return value;
}

Value item_value(const MissionItem& item, int number) {
  Value params = Value::list();
  for (const double p : item.params) params.push_back(p);
  Value value = made({{"type", "SimpleItem"},
                      {"autoContinue", true},
                      {"command", item.command},
                      {"doJumpId", number},
                      {"frame", item.frame},
                      {"params", params}});
  if (item.frame == mav::kRelative) {  // all three or none
    value.set("AMSLAltAboveTerrain", Value());
    value.set("Altitude", item.params[6]);
    value.set("AltitudeMode", kAboveHome);
  }
  return value;
}

std::vector<MissionItem> items_in(const Value& document) {
  std::vector<MissionItem> items;
  for (const Value& entry : document.at("mission").at("items").as_list()) {
    MissionItem item;
    item.command = static_cast<int>(entry.at("command").as_integer());
    item.frame = static_cast<int>(entry.at("frame").as_integer());
    const auto& params = entry.at("params").as_list();
    for (std::size_t i = 0; i < 7; ++i) item.params[i] = params.at(i).as_number();
    items.push_back(item);
  }
  return items;
}

class QgcPlan final : public Exporter {
 public:
  static constexpr PluginText kText{
      "qgc_plan", "1.0.0", "mission and fence for QGroundControl (.plan)",
      "https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html"};
  static ParameterTable parameters() { return mission_parameters(); }
  explicit QgcPlan(const Parameters& parameters) : options_(mission_file_options(parameters)) {}

  std::string file_extension() const override { return ".plan"; }
  bool shows_surroundings() const override { return true; }

  std::string write(const Plan& plan) const override {
    const PlannedMission mission = mission_of(plan, options_, "qgc_plan");
    const EarthFrame frame(plan, std::nullopt, "qgc_plan");
    Value items = Value::list();
    int number = 0;
    for (const MissionItem& item : mission.items) items.push_back(item_value(item, ++number));
    const double sea = home_above_sea(frame, mission.home, nullptr).value_or(0);
    const Value home(Value::List{mission.home.latitude_deg, mission.home.longitude_deg, sea});
    const Value document =
        made({{"fileType", "Plan"},
              {"version", 1},
              {"groundStation", states_certified(plan) ? "Lapwing" : "Lapwing (not certified)"},
              {"mission", made({{"version", 2},
                                {"firmwareType", options_.ardupilot ? kArduPilot : kPx4},
                                {"vehicleType", kQuadrotor},
                                {"cruiseSpeed", mission.cruise},
                                {"hoverSpeed", mission.cruise},
                                {"globalPlanAltitudeMode", kAboveHome},
                                {"plannedHomePosition", home},
                                {"items", items}})},
              {"geoFence", fences(mission, frame)},
              {"rallyPoints", made({{"version", 2}, {"points", rally_points(mission)}})}});
    return to_json(document) + "\n";
  }

  std::vector<std::string> losses(const Plan& plan, const std::string&) const override {
    PlannedMission mission = mission_of(plan, options_, "qgc_plan");
    home_above_sea(EarthFrame(plan, std::nullopt, "qgc_plan"), mission.home, &mission.said);
    return mission.said;
  }

  std::optional<FlownFile> flown(const Plan& plan, const std::string& written) const override {
    const Value document = from_json(written, "qgc_plan");
    const auto& home = document.at("mission").at("plannedHomePosition").as_list();
    const EarthFrame frame(plan, std::nullopt, "qgc_plan");
    const bool ardupilot = document.at("mission").at("firmwareType").as_integer() == kArduPilot;
    FlownFile flown =
        flight_of(items_in(document), frame, {home.at(0).as_number(), home.at(1).as_number(), 0},
                  take_off_z(plan, options_.home_z), ardupilot, plan);
    const PlannedMission mission = mission_of(plan, options_, "qgc_plan");
    flown.start = mission.start;
    flown.finish = mission.finish;
    return flown;
  }

 private:
  static Value rally_points(const PlannedMission& mission) {
    Value points = Value::list();
    for (const auto& [latitude, longitude, height] : mission.rally_points)
      points.push_back(Value(Value::List{latitude, longitude, height}));
    return points;
  }

  static Value fences(const PlannedMission& mission, const EarthFrame& frame) {
    Value circles = Value::list(), polygons = Value::list();
    const auto corner = [&](const Eigen::Vector2d& p) {
      const EarthPoint point = frame.at({p.x(), p.y(), mission.home_z});
      return Value(Value::List{point.latitude_deg, point.longitude_deg});
    };
    for (const MissionFence& fence : mission.fences) {
      if (fence.corners.empty()) {
        circles.push_back(
            made({{"circle", made({{"center", corner(fence.center)}, {"radius", fence.radius}})},
                  {"inclusion", fence.inclusion},
                  {"version", 1}}));
        continue;
      }
      Value outline = Value::list();
      for (const Eigen::Vector2d& p : fence.corners) outline.push_back(corner(p));
      polygons.push_back(
          made({{"polygon", outline}, {"inclusion", fence.inclusion}, {"version", 1}}));
    }
    return made({{"version", 2}, {"circles", circles}, {"polygons", polygons}});
  }

  MissionFileOptions options_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::QgcPlan)
