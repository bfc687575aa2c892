// SPDX-License-Identifier: Apache-2.0
#include "framework/app/plan_sources.h"

#include <algorithm>
#include <cmath>

#include "framework/app/stated_values.h"
#include "framework/config/lookup.h"
#include "framework/config/yaml.h"
#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/mission/environment_source.h"
#include "framework/mission/vehicle_source.h"
#include "framework/verify/judged_shape.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = std::size_t{1} << 30;  // bytes, as the verifier reads
constexpr const char* kOwnTable = "the plan's configuration";

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

// Obstacles of files beside `file`. A plan names files below its own folder. Those of a judge have
// names that no file there has.
void add_files(const Parameters& given, const char* list, const char* type, const fs::path& file,
               std::map<std::string, fs::path>& elsewhere, std::vector<Obstacle>& obstacles) {
  for (const Parameters& entry : given.tables(list)) {
    const fs::path there = fs::absolute(file).parent_path() / entry.text("file");
    Obstacle obstacle;
    obstacle.name = entry.text("name");
    const std::string name =
        "of the judge/" + std::to_string(elsewhere.size() + 1) + "/" + there.filename().string();
    elsewhere[name] = there;
    obstacle.type = type;
    obstacle.parameters.set("file", name);
    try {
      obstacle.parameters.set("sha256", sha256(read_file(there, kLargestFile)));
    } catch (const InputError& error) {
      throw InputError(entry.origin("file"), error.what());
    }
    obstacles.push_back(std::move(obstacle));
  }
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
    return {source, std::nullopt, "what " + source + " holds is not a vehicle"};
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

Plan with_environment(Plan plan, const fs::path& file, std::map<std::string, fs::path>& elsewhere) {
  ParameterTable named;
  named.text("name", "", "for messages").required_text("file", "in the folder of this file");
  ParameterTable table = shapes_table();
  table.tables("meshes", named, "obstacle, in metres with z up")
      .tables("maps", named, "occupied and unknown voxels are obstacles")
      .optional_number("margin", "m", "distance from every surface; absent: that of the plan",
                       at_least(0));
  Value whole = read_yaml(file), rest = Value::map(), stated = Value::list();
  rest.with_origin(whole.origin());
  if (whole.is_map())
    for (const auto& [key, value] : whole.as_map()) {
      if (key != "obstacles")
        rest.set(key, value);
      else
        stated = value;
    }
  const Parameters given = check(table, whole.is_map() ? rest : whole);
  Environment environment;
  environment.obstacles = shapes_of(given);
  add_files(given, "meshes", "mesh", file, elsewhere, environment.obstacles);
  add_files(given, "maps", "map", file, elsewhere, environment.obstacles);
  for (std::size_t i = 0; i < stated.as_list().size(); ++i) {
    const std::string what = "obstacles[" + std::to_string(i + 1) + "]";
    environment.obstacles.push_back(obstacle_from(stated.as_list()[i], what));
    Obstacle& obstacle = environment.obstacles.back();
    if (!judged_by_itself(obstacle.type) || obstacle.parameters.find("file"))
      throw InputError(stated.as_list()[i].origin(),
                       what + ": '" + obstacle.type +
                           "' is not a shape whose distance the verifier computes: sphere, "
                           "box, prism, capsule, cone, half_space; meshes and maps have lists");
    const std::string problem = problem_of(obstacle);
    if (!problem.empty()) throw InputError(stated.as_list()[i].origin(), what + problem);
  }
  environment.margin = given.has("margin") ? given.number("margin") : plan.environment.margin;
  environment.subjects = std::move(plan.environment.subjects);
  for (Obstacle& obstacle : plan.environment.obstacles)
    if (plan.task.scan && obstacle.type == "map" && obstacle.name == plan.task.scan->map)
      environment.obstacles.push_back(std::move(obstacle));
  plan.environment = std::move(environment);
  return plan;
}

std::vector<std::string> differences(const Value& plan, const Value& source,
                                     const std::string& source_name) {
  std::vector<std::string> found;
  add_differences(plan, source, source_name, "", found);
  return found;
}

}  // namespace lapwing
