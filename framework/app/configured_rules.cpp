// SPDX-License-Identifier: Apache-2.0
// Regions, zones and the pilot of a scan against its configuration.
#include <algorithm>

#include "framework/app/configured_task.h"
#include "framework/app/stated_values.h"

namespace lapwing {
namespace {

// Whether an entry states its polygon in the world frame, so that the plan has the same numbers.
bool stated_in_world(const Value& configuration, const Value& entry) {
  const std::string heights = stated_text(configuration, "heights");
  return stated_numbers(entry, "corners") && stated_text(entry, "file").empty() &&
         stated_text(configuration, "coordinates").empty() &&
         (heights.empty() || heights == "unstated" || heights == "world");
}

std::string entry_of(const std::string& option, std::size_t index) {
  return option + "[" + std::to_string(index + 1) + "]";
}

// Polygons of files and on the earth are counted, and the others are compared by `same`.
template <class Same>
void compare_polygons(const Value& configuration, const std::string& option, std::size_t here,
                      const Same& same, ConfigurationComparison& found) {
  const Value::List& entries = stated_tables(configuration, option.c_str());
  if (here < entries.size())
    found.faults.push_back(otherwise("the number of " + option, std::to_string(here),
                                     "at least " + std::to_string(entries.size())));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!stated_in_world(configuration, entries[i]))
      found.not_compared.push_back("the corners and heights of " + entry_of(option, i) +
                                   ": they are not stated in the world frame");
    else if (!same(entries[i]))
      found.faults.push_back(entry_of(option, i) +
                             " of its configuration is not in the plan as stated there");
  }
}

void compare_airspace(const Plan& plan, const std::string& option, Side side,
                      ConfigurationComparison& found) {
  std::vector<Obstacle> zones = plan.environment.obstacles;
  std::erase_if(zones,
                [&](const Obstacle& zone) { return zone.type != "prism" || zone.side != side; });
  const auto same = [&](const Value& entry) {
    return std::any_of(zones.begin(), zones.end(),
                       [&](const Obstacle& zone) { return same_zone(entry, zone); });
  };
  compare_polygons(plan.configuration, option, zones.size(), same, found);
}

bool same_outline(const Value& entry, const GroundPolygon& outline) {
  const auto corners = stated_numbers(entry, "corners");
  if (!corners || corners->size() != 2 * outline.size()) return false;
  for (std::size_t i = 0; i < outline.size(); ++i)
    if (!same_number((*corners)[2 * i], outline[i].x()) ||
        !same_number((*corners)[2 * i + 1], outline[i].y()))
      return false;
  return true;
}

bool same_prism(const Value& entry, const RegionPrism& prism) {
  const Value::List& holes = stated_tables(entry, "holes");
  const auto same = [&](const char* key, double here, double absent) {
    return same_number(stated_number(entry, key).value_or(absent), here);
  };
  if (!same_outline(entry, prism.outline) || holes.size() != prism.holes.size()) return false;
  for (std::size_t i = 0; i < holes.size(); ++i)
    if (!same_outline(holes[i], prism.holes[i])) return false;
  return same("from", prism.low, 0) && same("to", prism.high, 0) && same("weight", prism.weight, 1);
}

void compare_regions(const Plan& plan, ConfigurationComparison& found) {
  const std::vector<RegionPrism>& prisms = plan.task.scan->region.prisms();
  const auto same = [&](const Value& entry) {
    return std::any_of(prisms.begin(), prisms.end(),
                       [&](const RegionPrism& prism) { return same_prism(entry, prism); });
  };
  compare_polygons(plan.configuration, "regions", prisms.size(), same, found);
}

void compare_pilot(const Plan& plan, ConfigurationComparison& found) {
  const Value* asked = plan.configuration.find("pilot");
  const auto position = asked ? stated_numbers(*asked, "position") : std::nullopt;
  if (!position) return;
  const auto& pilot = plan.environment.pilot;
  if (!pilot) {
    found.faults.emplace_back("the plan has no pilot, and its configuration states one");
    return;
  }
  if (!same_vector(*position, pilot->eye))
    found.faults.emplace_back("pilot.position is not in the plan as its configuration states it");
  compare_number("pilot.range", pilot->range, stated_number(*asked, "range"), " m", Than::above,
                 found);
  compare_number("the distance within which nothing hides the flight from the pilot", pilot->beside,
                 PilotPlace{}.beside, " m", Than::above, found);
}

}  // namespace

void compare_flight_rules(const Plan& plan, ConfigurationComparison& found) {
  compare_airspace(plan, "no_fly_zones", Side::keep_out, found);
  compare_airspace(plan, "flight_zones", Side::keep_inside, found);
  compare_regions(plan, found);
  compare_pilot(plan, found);
  compare_number("the accuracy of the position", plan.environment.accuracy,
                 stated_number(plan.configuration, "gps_accuracy"), " m", Than::below, found);
}

}  // namespace lapwing
