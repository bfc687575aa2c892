// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/exporters/mission_checker.h"

#include <cmath>
#include <set>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

// Commands that PX4's and ArduPilot's documents list for multicopters, and those with a place.
const std::set<int> kCommands{16,  17,  19,  20,   21,   22,   93,   112,  114,
                              115, 177, 178, 195,  197,  203,  205,  206,  214,
                              530, 531, 532, 1000, 1001, 2000, 2001, 2500, 2501};
const std::set<int> kPlaces{16, 17, 19, 21, 22, 195};

class PlanChecker {
 public:
  std::vector<std::string> faults;

  void check(const std::string& text) {
    Value document;
    try {
      document = from_json(text, "plan");
    } catch (const InputError& error) {
      faults.push_back("no JSON");
      return;
    }
    expect_text(document, "fileType", "Plan");
    expect_integer(document, "version", 1, "");
    if (!is(document, "groundStation", Value::Type::text)) fault("groundStation");
    for (const char* key : {"mission", "geoFence", "rallyPoints"})
      if (!document.find(key) || !document.at(key).is_map()) {
        fault(std::string(key) + " is no object");
        return;
      }
    check_mission(document.at("mission"));
    check_fence(document.at("geoFence"));
    expect_integer(document.at("rallyPoints"), "version", 2, "rallyPoints.");
    if (!is(document.at("rallyPoints"), "points", Value::Type::list))
      fault("rallyPoints.points");
    else
      check_rally_points(document.at("rallyPoints").at("points").as_list());
  }

 private:
  void fault(const std::string& what) { faults.push_back(what); }

  // Degrees north and east, and a height above home: three numbers.
  void check_rally_points(const Value::List& points) {
    for (const Value& point : points) {
      const bool three = point.is_list() && point.as_list().size() == 3 &&
                         number(&point.as_list()[0]) && number(&point.as_list()[1]) &&
                         number(&point.as_list()[2]);
      if (!three || std::abs(point.as_list()[0].as_number()) > 90 ||
          std::abs(point.as_list()[1].as_number()) > 180)
        fault("rallyPoints.points is no place");
    }
  }

  static bool is(const Value& in, const char* key, Value::Type type) {
    const Value* value = in.find(key);
    return value && value->type() == type;
  }
  static bool number(const Value* value) {
    return value && value->is_number() && std::isfinite(value->as_number());
  }

  void expect_text(const Value& in, const char* key, const std::string& wanted) {
    if (!is(in, key, Value::Type::text) || in.at(key).as_text() != wanted) fault(key);
  }
  void expect_integer(const Value& in, const char* key, std::int64_t wanted,
                      const std::string& before) {
    if (!is(in, key, Value::Type::integer) || in.at(key).as_integer() != wanted)
      fault(before + key);
  }

  void check_place(const Value* list, std::size_t size, const std::string& what) {
    if (!list || !list->is_list() || list->as_list().size() != size) return fault(what);
    for (const Value& entry : list->as_list())
      if (!number(&entry)) return fault(what);
    if (std::abs(list->as_list()[0].as_number()) > 90 ||
        std::abs(list->as_list()[1].as_number()) > 180)
      fault(what + " is no place");
  }

  void check_mission(const Value& mission) {
    expect_integer(mission, "version", 2, "mission.");
    for (const char* key : {"firmwareType", "vehicleType", "globalPlanAltitudeMode"})
      if (!is(mission, key, Value::Type::integer)) fault(key);
    for (const char* key : {"cruiseSpeed", "hoverSpeed"})
      if (!number(mission.find(key))) fault(key);
    check_place(mission.find("plannedHomePosition"), 3, "plannedHomePosition");
    const Value* items = mission.find("items");
    if (!items || !items->is_list() || items->as_list().empty()) return fault("items");
    std::int64_t jump = 0;
    for (const Value& item : items->as_list()) check_item(item, ++jump);
  }

  void check_item(const Value& item, std::int64_t jump) {
    expect_text(item, "type", "SimpleItem");
    if (!is(item, "autoContinue", Value::Type::boolean)) fault("autoContinue");
    for (const char* key : {"frame", "command"})
      if (!is(item, key, Value::Type::integer)) return fault(key);
    if (item.find("doJumpId") && item.at("doJumpId").as_integer() != jump) fault("doJumpId");
    const auto command = static_cast<int>(item.at("command").as_integer());
    const auto frame = item.at("frame").as_integer();
    if (kCommands.count(command) == 0) fault("command " + std::to_string(command));
    const Value* params = item.find("params");
    if (!params || !params->is_list() || params->as_list().size() != 7)
      return fault("params must contain 7 values");
    for (std::size_t i = 0; i < 7; ++i) {
      const Value& p = params->as_list()[i];
      if (!number(&p) && !(i < 4 && p.is_null())) fault("param " + std::to_string(i + 1));
    }
    check_altitude(item, params->as_list()[6], frame);
    const bool place = kPlaces.count(command) > 0;
    if (place && frame == 2) fault("a place in the frame without places");
    if (!place && frame != 2 && command != 20) fault("frame of an item without a place");
    if (place && number(&params->as_list()[4]) && number(&params->as_list()[5])) {
      if (std::abs(params->as_list()[4].as_number()) > 90 ||
          std::abs(params->as_list()[5].as_number()) > 180 ||
          (params->as_list()[4].as_number() == 0 && params->as_list()[5].as_number() == 0))
        fault("no place on the earth");
    }
  }

  // All three or none; without them the loader takes every frame but the relative one for heights
  // above the sea, frame 10 (above terrain) among them.
  void check_altitude(const Value& item, const Value& height, std::int64_t frame) {
    int there = 0;
    for (const char* key : {"AltitudeMode", "Altitude", "AMSLAltAboveTerrain"})
      there += item.find(key) != nullptr;
    if (there != 0 && there != 3) return fault("altitude: all three or none");
    if (there == 0) {
      if (frame == 10) fault("altitude above terrain becomes one above the sea");
      return;
    }
    if (!is(item, "AltitudeMode", Value::Type::integer) || !number(item.find("Altitude")))
      return fault("altitude");
    const auto mode = item.at("AltitudeMode").as_integer();
    const bool fits = (mode == 1 && frame == 3) || (mode == 2 && frame == 0) ||
                      (mode == 3 && frame == 0) || (mode == 4 && frame == 10);
    if (!fits) fault("AltitudeMode of another frame");
    if (mode != 3 && number(&height) && item.at("Altitude").as_number() != height.as_number())
      fault("Altitude is not that of the params");
    if (!item.at("AMSLAltAboveTerrain").is_null() && !number(item.find("AMSLAltAboveTerrain")))
      fault("AMSLAltAboveTerrain");
  }

  void check_fence(const Value& fence) {
    expect_integer(fence, "version", 2, "geoFence.");
    for (const char* key : {"circles", "polygons"})
      if (!is(fence, key, Value::Type::list)) return fault(std::string("geoFence.") + key);
    for (const Value& entry : fence.at("circles").as_list()) {
      const Value* circle = entry.find("circle");
      if (!circle || !circle->is_map() || !number(circle->find("radius")) ||
          circle->at("radius").as_number() <= 0)
        fault("circle");
      else
        check_place(circle->find("center"), 2, "center");
      check_sides(entry);
    }
    for (const Value& entry : fence.at("polygons").as_list()) {
      const Value* polygon = entry.find("polygon");
      if (!polygon || !polygon->is_list() || polygon->as_list().size() < 3) {
        fault("polygon");
        continue;
      }
      double area = 0;
      const auto& corners = polygon->as_list();
      for (std::size_t i = 0; i < corners.size(); ++i) {
        check_place(&corners[i], 2, "corner");
        const auto &a = corners[i].as_list(), &b = corners[(i + 1) % corners.size()].as_list();
        area += a[1].as_number() * b[0].as_number() - b[1].as_number() * a[0].as_number();
      }
      if (area >= 0) fault("polygon is not clockwise");
      check_sides(entry);
    }
  }

  void check_sides(const Value& entry) {
    if (!is(entry, "inclusion", Value::Type::boolean)) fault("inclusion");
    expect_integer(entry, "version", 1, "geoFence entry ");
  }
};

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words{""};
  for (const char c : line)
    if (c == '\t')
      words.emplace_back();
    else
      words.back() += c;
  return words;
}

bool whole_number(const std::string& word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string::npos;
}

bool decimal(const std::string& word, double& number) {
  char* end = nullptr;
  number = std::strtod(word.c_str(), &end);
  return !word.empty() && *end == '\0' && std::isfinite(number);
}

std::string line_fault(const std::string& line, int number) {
  const std::vector<std::string> words = words_of(line);
  if (words.size() != 12) return "expected 12 words between tabs";
  for (const std::size_t i : {0u, 1u, 2u, 3u, 11u})
    if (!whole_number(words[i])) return "word " + std::to_string(i + 1);
  double values[7];
  for (std::size_t i = 0; i < 7; ++i)
    if (!decimal(words[4 + i], values[i])) return "word " + std::to_string(5 + i);
  if (words[0] != std::to_string(number)) return "number";
  if (words[1] != (number == 0 ? "1" : "0")) return "current";
  const int frame = std::stoi(words[2]), command = std::stoi(words[3]);
  // MAVSDK leaves degrees of other frames as they are.
  if (frame != 0 && frame != 3 && frame != 2) return "frame";
  if (number == 0 && (frame != 0 || command != 16)) return "home";
  if (number > 0 && frame == 0) return "height above the sea";
  if (kCommands.count(command) == 0) return "command";
  if ((kPlaces.count(command) > 0) != (frame == 3) && number > 0) return "frame of the command";
  if (frame != 2)
    for (const std::size_t i : {8u, 9u}) {  // a tenth of a millionth of a degree is 1.1 cm
      const std::size_t point = words[i].find('.');
      if (point == std::string::npos || words[i].size() - point - 1 < 7) return "decimals";
    }
  if (frame != 2 && (std::abs(values[4]) > 90 || std::abs(values[5]) > 180)) return "place";
  if (words[11] != "1") return "autocontinue";
  return "";
}

}  // namespace

std::vector<std::string> plan_faults(const std::string& text) {
  PlanChecker checker;
  checker.check(text);
  return checker.faults;
}

std::vector<std::string> waypoints_faults(const std::string& text) {
  std::vector<std::string> faults;
  std::istringstream lines(text);
  std::string line;
  if (!std::getline(lines, line) || line != "QGC WPL 110") faults.emplace_back("first line");
  int number = 0;
  for (; std::getline(lines, line); ++number)
    if (const std::string fault = line_fault(line, number); !fault.empty())
      faults.push_back("line " + std::to_string(number + 2) + ": " + fault);
  if (number < 2) faults.emplace_back("no items");
  return faults;
}

}  // namespace lapwing
