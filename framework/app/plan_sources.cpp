#include "framework/app/plan_sources.h"

#include <algorithm>
#include <cmath>

#include "framework/config/lookup.h"
#include "framework/config/yaml.h"
#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/mission/environment_source.h"
#include "framework/mission/vehicle_source.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = std::size_t{1} << 30;  // bytes, as the verifier reads
constexpr const char* kOwnTable = "the plan's configuration";

bool same_number(double a, double b) {
  return std::abs(a - b) <= 1e-12 * std::max({1.0, std::abs(a), std::abs(b)});
}

bool same_value(const Value& a, const Value& b) {
  if (a.is_number() && b.is_number()) return same_number(a.as_number(), b.as_number());
  if (!a.is_list() || !b.is_list()) return a == b;
  return std::equal(a.as_list().begin(), a.as_list().end(), b.as_list().begin(), b.as_list().end(),
                    same_value);
}

void add_differences(const Value& plan, const Value& source, const std::string& source_name,
                     const std::string& key, std::vector<std::string>& found) {
  if (plan.is_map() && source.is_map()) {
    const std::string prefix = key.empty() ? "" : key + ".";
    for (const auto& [name, value] : plan.as_map()) {
      const Value* there = source.find(name);
      add_differences(value, there ? *there : Value(), source_name, prefix + name, found);
    }
    for (const auto& [name, value] : source.as_map())
      if (!plan.find(name)) add_differences(Value(), value, source_name, prefix + name, found);
    return;
  }
  if (same_value(plan, source)) return;
  const auto shown = [](const Value& value) {
    return value.is_null()     ? "not stated"
           : value.is_number() ? plain_number(value.as_number(), 12)
                               : to_json(value, -1);
  };
  found.push_back(key + " is " + shown(plan) + " in the plan and " + shown(source) + " in " +
                  source_name);
}

// Of a list in the configuration, the numbers of one key; nothing where it is none.
std::optional<std::vector<double>> stated_numbers(const Value& table, const char* key) {
  const Value* list = table.find(key);
  if (!list || !list->is_list()) return std::nullopt;
  std::vector<double> numbers;
  for (const Value& entry : list->as_list()) {
    if (!entry.is_number()) return std::nullopt;
    numbers.push_back(entry.as_number());
  }
  return numbers;
}
std::optional<double> stated_number(const Value& table, const char* key) {
  const Value* value = table.find(key);
  return value && value->is_number() ? std::optional(value->as_number()) : std::nullopt;
}
std::string stated_text(const Value& table, const char* key) {
  const Value* value = table.find(key);
  return value && value->is_text() ? value->as_text() : "";
}
const Value::List& stated_tables(const Value& configuration, const char* key) {
  static const Value::List none;
  const Value* list = configuration.find(key);
  if (!list || !list->is_list()) return none;
  return list->as_list();
}

template <class Vector>
bool same_vector(const std::vector<double>& given, const Vector& v) {
  if (given.size() != static_cast<std::size_t>(v.size())) return false;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!same_number(given[i], v[static_cast<Eigen::Index>(i)])) return false;
  return true;
}

bool same_zone(const Value& stated, const Zone& zone) {
  const auto corners = stated_numbers(stated, "corners");
  if (!corners || corners->size() != 2 * zone.corners.size()) return false;
  for (std::size_t i = 0; i < zone.corners.size(); ++i)
    if (!same_number((*corners)[2 * i], zone.corners[i].x()) ||
        !same_number((*corners)[2 * i + 1], zone.corners[i].y()))
      return false;
  const Zone open;
  const auto bound = [&](const char* key, double there, double absent) {
    const double asked = stated_number(stated, key).value_or(absent);
    return asked == there || same_number(asked, there);
  };
  return bound("floor", zone.floor, open.floor) && bound("ceiling", zone.ceiling, open.ceiling);
}

// Compares what a plan has with what its configuration asks for.
class Configured {
 public:
  explicit Configured(const Plan& plan) : plan_(plan), asked_(plan.configuration) {}

  std::vector<std::string> weaker() {
    if (!asked_.is_map() || plan_.kind != "film") return {};
    obstacles();
    zones();
    keyframes();
    subjects();
    at_least("margin", plan_.environment.margin, "margin");
    if (!plan_.task.framing.empty())
      at_least("framing", plan_.task.framing_share, "share of framing");
    const auto battery = stated_number(asked_, "battery");
    if (battery && !(plan_.budget && *plan_.budget <= *battery * (1 + 1e-12)))
      add("the budget is " + (plan_.budget ? plain_number(*plan_.budget) + " s" : "not stated"),
          plain_number(*battery) + " s");
    return std::move(found_);
  }

 private:
  void add(const std::string& here, const std::string& asked) {
    found_.push_back(here + " in the plan and " + asked + " in its configuration");
  }

  void at_least(const char* key, double here, const std::string& what) {
    const auto asked = stated_number(asked_, key);
    if (asked && here < *asked && !same_number(here, *asked))
      add("the " + what + " is " + plain_number(here), plain_number(*asked));
  }

  bool has(const Value& obstacle) const {
    const Environment& e = plan_.environment;
    const std::string type = stated_text(obstacle, "type");
    const auto any = [](const auto& list, const auto& is) {
      return std::any_of(list.begin(), list.end(), is);
    };
    if (type == "sphere") {
      const auto center = stated_numbers(obstacle, "center");
      const auto radius = stated_number(obstacle, "radius");
      return !center || !radius || any(e.spheres, [&](const Sphere& s) {
        return same_vector(*center, s.center) && same_number(*radius, s.radius);
      });
    }
    if (type == "box") {
      const auto lower = stated_numbers(obstacle, "lower"),
                 upper = stated_numbers(obstacle, "upper");
      return !lower || !upper || any(e.boxes, [&](const Box& b) {
        return same_vector(*lower, b.lower) && same_vector(*upper, b.upper);
      });
    }
    if (type == "no_fly_zone")
      return any(e.zones, [&](const Zone& zone) { return same_zone(obstacle, zone); });
    return true;  // files: they are counted
  }

  void obstacles() {
    std::size_t meshes = 0, maps = 0, index = 0;
    for (const Value& obstacle : stated_tables(asked_, "obstacles")) {
      ++index;
      if (!obstacle.is_map()) continue;
      meshes += stated_text(obstacle, "type") == "mesh";
      maps += stated_text(obstacle, "type") == "map";
      if (!has(obstacle))
        found_.push_back("obstacles[" + std::to_string(index) + "] of its configuration (" +
                         stated_text(obstacle, "type") + " '" + stated_text(obstacle, "name") +
                         "') is not in the plan as stated there");
    }
    const auto count = [&](const char* what, std::size_t here, std::size_t asked) {
      if (here < asked)
        add("there are " + std::to_string(here) + " " + what, std::to_string(asked));
    };
    count("meshes", plan_.environment.meshes.size(), meshes);
    count("maps", plan_.environment.maps.size(), maps);
  }

  void zones() {
    std::size_t index = 0;
    for (const Value& zone : stated_tables(asked_, "flight_zones")) {
      ++index;
      const auto& zones = plan_.environment.flight_zones;
      if (zone.is_map() && std::none_of(zones.begin(), zones.end(),
                                        [&](const Zone& z) { return same_zone(zone, z); }))
        found_.push_back("flight_zones[" + std::to_string(index) +
                         "] of its configuration is not in the plan as stated there");
    }
  }

  void keyframes() {
    const Value::List& asked = stated_tables(asked_, "keyframes");
    const auto& here = plan_.task.keyframes;
    if (asked.empty()) return;
    if (here.size() != asked.size())
      return add("there are " + std::to_string(here.size()) + " keyframes",
                 std::to_string(asked.size()));
    for (std::size_t i = 0; i < here.size(); ++i) {
      const auto position = stated_numbers(asked[i], "position");
      if (position && !same_vector(*position, here[i].position))
        found_.push_back("keyframe " + std::to_string(i + 1) +
                         " is elsewhere in the plan than in its configuration");
    }
    const auto hard = stated_number(asked_, "hard");
    for (std::size_t i = 0; hard && i < here.size(); ++i)
      if (here[i].tolerance > *hard && !same_number(here[i].tolerance, *hard))
        return add("the tolerance of keyframe " + std::to_string(i + 1) + " is " +
                       plain_number(here[i].tolerance) + " m",
                   plain_number(*hard) + " m");
  }

  void subjects() {
    for (const Value& asked : stated_tables(asked_, "subjects")) {
      if (!asked.is_map() || !stated_number(asked, "distance")) continue;
      const double distance = *stated_number(asked, "distance");
      const std::string name = stated_text(asked, "name");
      for (const Subject& subject : plan_.environment.subjects)
        if (subject.name == name && subject.distance < distance &&
            !same_number(subject.distance, distance))
          add("the distance from subject '" + name + "' is " + plain_number(subject.distance) +
                  " m",
              plain_number(distance) + " m");
    }
  }

  const Plan& plan_;
  const Value& asked_;
  std::vector<std::string> found_;
};

template <class Obstacle>
std::vector<Obstacle> files_from(const Parameters& given, const char* list, const fs::path& file) {
  std::vector<Obstacle> obstacles;
  for (const Parameters& entry : given.tables(list)) {
    const fs::path there = fs::absolute(file).parent_path() / entry.text("file");
    Obstacle obstacle;
    obstacle.name = entry.text("name");
    obstacle.file = there.string();
    try {
      obstacle.sha256 = sha256(read_file(there, kLargestFile));
    } catch (const InputError& error) {
      throw InputError(entry.origin("file"), error.what());
    }
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

bool is_in(const fs::path& configs, const std::string& name) {
  ConfigSearch search;
  search.folders = {configs};
  search.any_path = false;
  try {
    find_config(name, search);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

VehicleSource loaded(const std::string& source, const Value& stated, const fs::path& configs) {
  try {
    return {source, load_vehicle(stated, {configs})};
  } catch (const InputError&) {
    return {source, std::nullopt, "what " + source + " holds is no vehicle"};
  }
}

}  // namespace

VehicleSource vehicle_source_of(const Plan& plan, const fs::path& configs) {
  const Value* stated = plan.configuration.find("vehicle");
  const std::string flown = stated_text(plan.vehicle, "name");
  // Whoever bears the name of a shipped file is compared with it, whatever else is stated.
  if (is_in(configs, flown)) {
    VehicleSource source = loaded("configs/" + flown + (flown.ends_with(".yaml") ? "" : ".yaml"),
                                  Value(flown), configs);
    if (stated && *stated != Value(flown))
      source.problem = "the vehicle is '" + flown + "' in the plan and " +
                       (stated->is_text() ? "'" + stated->as_text() + "'" : "a table") +
                       " in its configuration";
    return source;
  }
  if (!stated || stated->is_null()) return {"the script", std::nullopt};
  if (stated->is_map()) {
    // Its camera's file may lie beside the script.
    const std::string camera = stated_text(*stated, "camera");
    if (!camera.empty() && !is_in(configs, camera)) return {kOwnTable, std::nullopt};
    return loaded(kOwnTable, *stated, configs);
  }
  if (*stated == Value(flown)) return {"the script", std::nullopt};
  return {"the script", std::nullopt,
          "the vehicle is '" + flown + "' in the plan and " + to_json(*stated, -1) +
              " in its configuration"};
}

VehicleSource read_vehicle_file(const fs::path& file, const fs::path& configs) {
  ConfigSearch search;
  search.folders = {configs};
  try {
    const Value given = read_config(file.string(), search);
    const fs::path found = find_config(file.string(), search);
    return {file.string(), load_vehicle(given, {found.parent_path(), configs})};
  } catch (const InputError& error) {
    throw InputError(std::string("--vehicle: ") + error.what());
  }
}

Plan with_environment(Plan plan, const fs::path& file) {
  ParameterTable named;
  named.text("name", "", "for messages").required_text("file", "beside this file");
  ParameterTable table = shapes_table();
  table.tables("meshes", named, "to keep away from, in metres with z up")
      .tables("maps", named, "occupied or unknown: to keep away from")
      .optional_number("margin", "m", "kept from every surface; absent: as the plan has it",
                       at_least(0));
  const Parameters given = check(table, read_yaml(file));
  Environment environment = shapes_of(given);
  environment.meshes = files_from<MeshObstacle>(given, "meshes", file);
  environment.maps = files_from<MapObstacle>(given, "maps", file);
  environment.margin = given.has("margin") ? given.number("margin") : plan.environment.margin;
  environment.subjects = std::move(plan.environment.subjects);
  for (MapObstacle& map : plan.environment.maps)
    if (plan.task.scan && map.name == plan.task.scan->map)
      environment.maps.push_back(std::move(map));
  plan.environment = std::move(environment);
  return plan;
}

std::vector<std::string> differences(const Value& plan, const Value& source,
                                     const std::string& source_name) {
  std::vector<std::string> found;
  add_differences(plan, source, source_name, "", found);
  return found;
}

std::vector<std::string> weaker_than_configured(const Plan& plan) {
  return Configured(plan).weaker();
}

}  // namespace lapwing
