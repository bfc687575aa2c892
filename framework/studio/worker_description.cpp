// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "framework/config/yaml.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/studio/worker_errands.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// "vehicles/solo" for every file of a folder of configurations, in order.
std::vector<std::string> files_in(const fs::path& configs, const std::string& folder) {
  std::vector<std::string> names;
  std::error_code code;
  for (const auto& item : fs::directory_iterator(configs / folder, code))
    if (item.path().extension() == ".yaml")
      names.push_back(folder + "/" + item.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Value names_of(const Registry& registry, const std::string& kind) {
  Value names = Value::list();
  for (const PluginEntry& entry : registry.entries())
    if (entry.kind == kind) names.push_back(entry.name);
  return names;
}

// Each with what it says: {name, layer}.
Value contents_in(const fs::path& configs, const std::string& folder) {
  Value all = Value::list();
  for (const std::string& name : files_in(configs, folder)) {
    Value one = Value::map();
    one.set("name", name);
    one.set("layer", read_yaml(configs / (name + ".yaml")));
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

void describe_mission(const Mission& mission, const MissionSettings& settings, Value& described) {
  const Registry& registry = *settings.registry;
  Value& schema = described.set("schema", Value::map());
  schema.set("options", mission.declarations());
  Value& plugins = schema.set("plugins", Value::map());
  for (const PluginEntry& entry : registry.entries()) {
    Value* kind = plugins.find(entry.kind);
    if (!kind) kind = &plugins.set(entry.kind, Value::map());
    Value& one = kind->set(entry.name, Value::map());
    one.set("summary", as_utf8(entry.summary));
    one.set("parameters", entry.parameters.to_value());
  }
  Value& choices = described.set("choices", Value::map());
  Value cameras = Value::list();
  for (const std::string& name : files_in(settings.configs, "cameras")) cameras.push_back(name);
  choices.set("vehicle", contents_in(settings.configs, "vehicles"));
  choices.set("camera", std::move(cameras));
  choices.set("solver", names_of(registry, "trajectory_solver"));
  choices.set("exporters", names_of(registry, "exporter"));
  choices.set("shapes", names_of(registry, "shape"));
  choices.set("controllers", names_of(registry, "controller"));
  choices.set("style", contents_in(settings.configs, "filming"));
}

}  // namespace lapwing
