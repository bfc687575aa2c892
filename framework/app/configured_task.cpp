// SPDX-License-Identifier: Apache-2.0
#include "framework/app/configured_task.h"

#include "framework/app/stated_values.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

struct Kind {
  const char* name;
  std::vector<const char*> options;  // that missions of this kind alone have, all of them
  void (*compare)(const Plan&, ConfigurationComparison&);
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"film", {"passages", "path_tolerance", "stretch", "timing"}, compare_film},
      {"race", {"closed_loop", "laps", "rate_share", "refinements"}, compare_race},
      {"scan", {"candidates", "closed_loop", "motions", "tour"}, compare_scan},
      {"light_painting", {"reorder", "rounding", "slowest", "origin"}, compare_light_painting}};
  return all;
}

bool has_all(const Value& configuration, const std::vector<const char*>& options) {
  return std::all_of(options.begin(), options.end(),
                     [&](const char* option) { return configuration.find(option) != nullptr; });
}

// The number that an obstacle records, or what stands for none.
double recorded(const Obstacle& obstacle, const char* key, double absent) {
  const Value* found = obstacle.parameters.find(key);
  return found && found->is_number() ? found->as_number() : absent;
}

template <class List, class Is>
bool any(const List& list, const Is& is) {
  return std::any_of(list.begin(), list.end(), is);
}

// Whether what a record states is what the configuration states, as far as it states it.
bool same_record(const Value& stated, const Obstacle& obstacle) {
  const auto same = [&](const std::string& key, const Value& value) {
    if (value.is_number()) {
      const auto number = stated_number(stated, key.c_str());
      return !number || same_number(*number, value.as_number());
    }
    if (!value.is_list()) return true;
    const auto numbers = stated_numbers(stated, key.c_str());
    const auto here = recorded_numbers(obstacle.parameters, key);
    if (!numbers) return true;
    if (numbers->size() != here.size()) return false;
    for (std::size_t i = 0; i < here.size(); ++i)
      if (!same_number((*numbers)[i], here[i])) return false;
    return true;
  };
  for (const auto& [key, value] : obstacle.parameters.as_map())
    if (!same(key, value)) return false;
  return true;
}

// A file bears the obstacle's name, or its own.
bool has_obstacle(const Value& stated, const Environment& e) {
  std::string type = stated_text(stated, "type");
  const bool zone = type == "no_fly_zone";
  if (zone) type = "prism";
  const std::string side = stated_text(stated, "side");
  const Value* hides = stated.find("opaque");  // true where nothing is stated
  const bool opaque = !hides || hides->type() != Value::Type::boolean || hides->as_boolean();
  const std::string own = stated_text(stated, "name"), file = stated_text(stated, "file");
  return std::any_of(e.obstacles.begin(), e.obstacles.end(), [&](const Obstacle& obstacle) {
    if (obstacle.type != type) return false;
    if ((obstacle.side == Side::keep_inside) != (side == "keep_inside")) return false;
    if (!same_track(stated, obstacle) || (opaque && !obstacle.opaque)) return false;
    if (!file.empty()) return obstacle.name == (own.empty() ? file : own);
    return type == "prism" ? same_zone(stated, obstacle) : same_record(stated, obstacle);
  });
}

void compare_obstacles(const Plan& plan, ConfigurationComparison& found) {
  const Environment& e = plan.environment;
  std::size_t meshes = 0, maps = 0, index = 0;
  for (const Value& obstacle : stated_tables(plan.configuration, "obstacles")) {
    ++index;
    meshes += stated_text(obstacle, "type") == "mesh";
    maps += stated_text(obstacle, "type") == "map";
    if (!has_obstacle(obstacle, e))
      found.faults.push_back("obstacles[" + std::to_string(index) + "] of its configuration (" +
                             stated_text(obstacle, "type") + " '" + stated_text(obstacle, "name") +
                             "') is not in the plan as stated there");
  }
  const auto count = [&](const char* what, const char* type, std::size_t asked) {
    const auto here = static_cast<std::size_t>(
        std::count_if(e.obstacles.begin(), e.obstacles.end(),
                      [&](const Obstacle& obstacle) { return obstacle.type == type; }));
    if (here < asked)
      found.faults.push_back(otherwise(std::string("the number of ") + what, std::to_string(here),
                                       std::to_string(asked)));
  };
  count("meshes", "mesh", meshes);
  count("maps", "map", maps);
  if (meshes + maps > 0)
    found.not_compared.push_back(
        "the content of mesh and map files: they are compared by name and number");
}

void compare_zones(const Plan& plan, ConfigurationComparison& found) {
  std::vector<Obstacle> zones = plan.environment.obstacles;
  std::erase_if(zones, [](const Obstacle& o) { return o.side != Side::keep_inside; });
  std::size_t index = 0;
  for (const Value& zone : stated_tables(plan.configuration, "flight_zones")) {
    ++index;
    if (!any(zones, [&](const Obstacle& z) { return same_zone(zone, z); }))
      found.faults.push_back("flight_zones[" + std::to_string(index) +
                             "] of its configuration is not in the plan as stated there");
  }
  const Value* volume = plan.configuration.find("volume");
  if (!volume || !volume->is_map()) return;
  const auto low = stated_numbers(*volume, "lower"), high = stated_numbers(*volume, "upper");
  if (!low || !high || low->size() != 3 || high->size() != 3) return;
  const std::vector<double>&l = *low, &h = *high;
  Value box = Value::map();
  Value::List corners;
  for (const double c : {l[0], l[1], h[0], l[1], h[0], h[1], l[0], h[1]}) corners.push_back(c);
  box.set("corners", Value(corners));
  box.set("floor", l[2]);
  box.set("ceiling", h[2]);
  if (!any(zones, [&](const Obstacle& z) { return same_zone(box, z); }))
    found.faults.push_back("the volume of its configuration is not in the plan as stated there");
}

// What the take-off place is asked to be, and what counts from it.
void compare_home(const Plan& plan, ConfigurationComparison& found) {
  const Value* asked = plan.configuration.find("home");
  const auto position = asked ? stated_numbers(*asked, "position") : std::nullopt;
  if (!position) return;
  if (!plan.home) {
    found.faults.emplace_back("the plan has no home, and its configuration states one");
    return;
  }
  const Home& home = *plan.home;
  if (!same_vector(*position, home.position))
    found.faults.emplace_back("home.position is not in the plan as its configuration states it");
  const auto compare = [&](const std::string& key, const std::optional<double>& here) {
    const auto limit = stated_number(*asked, key.c_str());
    if (limit && !here)
      found.faults.push_back("the plan has no home." + key + ", and its configuration states one");
    else if (limit)
      compare_number("home." + key, *here, limit, " m", Than::above, found);
  };
  compare("max_height", home.max_height);
  compare("max_distance", home.max_distance);
  const auto& points = stated_tables(*asked, "rally_points");
  bool same = points.size() == home.rally_points.size();
  for (std::size_t i = 0; same && i < points.size(); ++i) {
    const auto point = stated_numbers(points[i], "position");
    same = point && same_vector(*point, home.rally_points[i]);
  }
  if (!same)
    found.faults.emplace_back(
        "home.rally_points are not in the plan as its configuration states "
        "them");
}

// The place of the world on the earth, from which heights count.
void compare_origin(const Plan& plan, ConfigurationComparison& found) {
  const Value* asked = plan.configuration.find("origin");
  const auto latitude = asked ? stated_number(*asked, "latitude_deg") : std::nullopt;
  const auto longitude = asked ? stated_number(*asked, "longitude_deg") : std::nullopt;
  const auto height = asked ? stated_number(*asked, "height") : std::nullopt;
  if (!latitude || !longitude || !height) return;
  const auto& here = plan.geodetic_origin;
  if (here && same_number(here->latitude_deg, *latitude) &&
      same_number(here->longitude_deg, *longitude) && same_number(here->height, *height) &&
      to_string(here->height_of) == stated_text(*asked, "height_of"))
    return;
  found.faults.emplace_back(here ? "the origin is not in the plan as its configuration states it"
                                 : "the plan has no origin, and its configuration states one");
}

}  // namespace

bool same_zone(const Value& stated, const Obstacle& zone) {
  constexpr double kOpen = std::numeric_limits<double>::infinity();
  if (zone.type != "prism") return false;
  const auto corners = stated_numbers(stated, "corners");
  const auto recorded_corners = recorded_numbers(zone.parameters, "corners");
  if (!corners || corners->size() != recorded_corners.size()) return false;
  for (std::size_t i = 0; i < corners->size(); ++i)
    if (!same_number((*corners)[i], recorded_corners[i])) return false;
  return same_number(stated_number(stated, "floor").value_or(-kOpen),
                     recorded(zone, "floor", -kOpen)) &&
         same_number(stated_number(stated, "ceiling").value_or(kOpen),
                     recorded(zone, "ceiling", kOpen));
}

std::string otherwise(const std::string& what, const std::string& here, const std::string& asked) {
  return what + " is " + here + " in the plan and " + asked + " in its configuration";
}

void compare_number(const std::string& what, double here, std::optional<double> asked,
                    const std::string& unit, Than wrong, ConfigurationComparison& found) {
  if (!asked || same_number(here, *asked)) return;
  if ((wrong == Than::above && here < *asked) || (wrong == Than::below && here > *asked)) return;
  found.faults.push_back(otherwise(what, plain_number(here) + unit, plain_number(*asked) + unit));
}

void compare_surroundings(const Plan& plan, ConfigurationComparison& found) {
  compare_obstacles(plan, found);
  compare_ground(plan, found);
  compare_zones(plan, found);
  compare_number("the margin", plan.environment.margin, stated_number(plan.configuration, "margin"),
                 " m", Than::below, found);
}

ConfigurationComparison compare_with_configuration(const Plan& plan) {
  ConfigurationComparison found;
  if (!plan.configuration.is_map()) {
    found.not_compared.push_back("obstacles and task: the plan states no configuration");
    return found;
  }
  compare_origin(plan, found);
  compare_home(plan, found);
  compare_motion(plan, found);
  for (const Kind& kind : kinds()) {
    // The options tell the kind where another name was put on the plan.
    const bool by_options = has_all(plan.configuration, kind.options);
    if (by_options && plan.kind != kind.name)
      found.faults.push_back("the kind is '" + plan.kind +
                             "' in the plan, and its configuration has the options of '" +
                             kind.name + "'");
    if (!by_options && plan.kind != kind.name) continue;
    kind.compare(plan, found);
    return found;
  }
  found.not_compared.push_back("obstacles and task: missions of kind '" + plan.kind +
                               "' are not compared with their configuration");
  return found;
}

}  // namespace lapwing
