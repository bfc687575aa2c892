// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>

#include "framework/app/scan_check.h"
#include "framework/core/units.h"
#include "framework/trajectory/plan.h"

namespace lapwing {
namespace {

// Options of the first flight, of candidates, which the views replace, and of several batteries:
// the rest is one tour.
const std::set<std::string> kLeftOut{"scene",     "scene_seed",     "scene_districts",
                                     "input",     "ground",         "unit",
                                     "up",        "prior",          "flights",
                                     "noise",     "exploration",    "utility",
                                     "folder",    "images",         "colmap",
                                     "cloud",     "terrain",        "surface",
                                     "rounds",    "start",          "candidates",
                                     "motions",   "resolution",     "passing",
                                     "views",     "region",         "finish",
                                     "batteries", "drones",         "fleet",
                                     "accuracy",  "accuracy_share", "city",
                                     "tiles",     "pinned",         "forbidden"};
const std::set<std::string> kKeywords{"and",   "break", "do",       "else", "elseif", "end",
                                      "false", "for",   "function", "goto", "if",     "in",
                                      "local", "nil",   "not",      "or",   "repeat", "return",
                                      "then",  "true",  "until",    "while"};
constexpr double kHeadroom = 0.5;  // m above the highest view, where no ceiling is stated

std::string quoted_lua(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') quoted += '\\';
    if (byte >= 32 && byte != 127) {
      quoted += c;
      continue;
    }
    char escaped[8];
    std::snprintf(escaped, sizeof escaped, "\\%03d", byte);
    quoted += escaped;
  }
  return quoted + "\"";
}

// The shortest text that reads back as the same number.
std::string lua_number(double number) {
  if (std::isinf(number)) return number > 0 ? "math.huge" : "-math.huge";
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string lua_key(const std::string& key) {
  const bool plain = !key.empty() && !std::isdigit(static_cast<unsigned char>(key.front())) &&
                     !kKeywords.contains(key) &&
                     std::all_of(key.begin(), key.end(),
                                 [](unsigned char c) { return std::isalnum(c) || c == '_'; });
  return plain ? key : "[" + quoted_lua(key) + "]";
}

// A pilot without a place is none: what is left of the table are defaults.
bool is_no_pilot(const std::string& key, const Value& value) {
  if (key != "pilot" || !value.is_map()) return false;
  const Value* position = value.find("position");
  return !position || position->is_null() || (position->is_list() && position->as_list().empty());
}

// Whether a table holds nothing: as if it were absent.
bool says_nothing(const Value& value) {
  if (value.is_null()) return true;
  if (value.is_list()) return value.as_list().empty();
  if (!value.is_map()) return false;
  return std::all_of(value.as_map().begin(), value.as_map().end(),
                     [](const auto& entry) { return says_nothing(entry.second); });
}

std::string lua_value(const Value& value) {
  if (value.is_text()) return quoted_lua(value.as_text());
  if (value.type() == Value::Type::boolean) return value.as_boolean() ? "true" : "false";
  if (value.type() == Value::Type::integer) return std::to_string(value.as_integer());
  if (value.is_number()) return lua_number(value.as_number());
  std::string text;
  if (value.is_list())
    for (const Value& entry : value.as_list())
      text += (text.empty() ? "" : ", ") + lua_value(entry);
  if (value.is_map())
    for (const auto& [key, entry] : value.as_map())
      if (!says_nothing(entry))
        text += (text.empty() ? "" : ", ") + lua_key(key) + " = " + lua_value(entry);
  return "{ " + text + " }";
}

std::string lua_point(const Eigen::Vector3d& p) {
  return "{ " + lua_number(p.x()) + ", " + lua_number(p.y()) + ", " + lua_number(p.z()) + " }";
}

}  // namespace

std::string rest_mission(const Plan& plan, const std::vector<std::size_t>& missing) {
  const ScanTask& scan = *plan.task.scan;
  const Eigen::Vector3d start = plan.trajectory.samples.front().position;
  std::string text = "-- The views of '";
  for (const char c : plan.mission) text += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  text +=
      "' that have no photograph yet.\nlocal scan = require \"mission.scan\"\n\n"
      "return scan.of_prior {\n  name = " +
      quoted_lua(plan.mission + " rest") +
      ",\n  prior = { map = \"map.ot\", mesh = \"prior.ply\" },\n  start = " + lua_point(start) +
      ",\n";
  const Value* region = plan.configuration.find("region");
  const Value* polygons = plan.configuration.find("regions");  // copied below like other options
  if (region && !says_nothing(*region))
    text += "  region = " + lua_value(*region) + ",\n";
  else if (!polygons || says_nothing(*polygons))
    text += "  region = { lower = " + lua_point(scan.region.bounds().min()) +
            ", upper = " + lua_point(scan.region.bounds().max()) + " },\n";
  double highest = start.z();
  for (const std::size_t k : missing) highest = std::max(highest, scan.views[k].position.z());
  const Value* ceiling = plan.configuration.find("ceiling");
  if (!ceiling || ceiling->is_null())
    text += "  ceiling = " + lua_number(highest + kHeadroom) + ",\n";
  if (plan.configuration.is_map())
    for (const auto& [key, value] : plan.configuration.as_map())
      if (!kLeftOut.contains(key) && !says_nothing(value) && !is_no_pilot(key, value))
        text += "  " + lua_key(key) + " = " + lua_value(value) + ",\n";
  text += "  views = {\n";
  for (const std::size_t k : missing) {
    const PlannedView& view = scan.views[k];
    text += "    { position = " + lua_point(view.position) +
            ", yaw_deg = " + lua_number(degrees(std::remainder(view.yaw, 2 * EIGEN_PI))) +
            ", pitch_deg = " + lua_number(degrees(view.pitch)) + " },  -- view " +
            std::to_string(k + 1) + "\n";
  }
  return text + "  },\n}\n";
}

}  // namespace lapwing
