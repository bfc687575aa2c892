// SPDX-License-Identifier: Apache-2.0
#include "framework/app/completion_names.h"

#include <algorithm>
#include <iostream>
#include <map>

#include "framework/app/mission_loading.h"
#include "framework/config/shipped.h"
#include "framework/core/files.h"
#include "framework/study/reproduction.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// "scan/small" for every file of configs/ that `wanted` takes.
Names configurations(bool (*wanted)(const std::string& folder)) {
  const fs::path configs = shipped_folder("configs");
  Names names;
  for (const auto& item : fs::recursive_directory_iterator(configs)) {
    const fs::path name = item.path().lexically_relative(configs);
    if (name.extension() == ".yaml" && wanted(name.parent_path().string()))
      names.push_back((name.parent_path() / name.stem()).string());
  }
  return names;
}

// Scripts of scripts/scene that make a scene: they return a function, parts of scenes a table.
Names scenes() {
  Names names;
  for (const auto& item : fs::directory_iterator(shipped_folder("scripts") / "scene"))
    if (item.path().extension() == ".lua" &&
        read_file(item.path()).find("\nreturn function(") != std::string::npos)
      names.push_back(item.path().stem().string());
  return names;
}

// Names of templates: folders, or files without their endings.
Names templates_in(const char* folder) {
  Names names;
  for (const auto& item : fs::directory_iterator(shipped_folder("scripts") / "templates" / folder))
    names.push_back(item.path().stem().stem().string());
  return names;
}

Names plugins_of(const Invocation& invocation, const std::string& kind) {
  Names names;
  const Registry registry = invocation.registry();
  for (const PluginEntry& entry : registry.entries())
    if (entry.kind == kind) names.push_back(entry.name);
  return names;
}

// Sorted, and without those that a shell would read as more than a name.
Names without_signs(Names names) {
  std::erase_if(names, [](const std::string& name) {
    return name.empty() || !std::all_of(name.begin(), name.end(), [](char c) {
             return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                    std::string_view("_-./+=").find(c) != std::string_view::npos;
           });
  });
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

// What `lapwing reproduce` makes.
Names tables() {
  Names names = reproduction_names(shipped_folder("configs") / "reproduce");
  names.push_back("list");
  return names;
}

using List = Names (*)(const Invocation&);

const std::map<std::string, List>& lists() {
  static const std::map<std::string, List> all{
      {"config",
       [](const Invocation&) {
         return configurations([](const std::string& folder) {
           return !folder.empty() && folder != "vehicles" && folder != "cameras" &&
                  folder != "reproduce";
         });
       }},
      {"table", [](const Invocation&) { return tables(); }},
      {"vehicle",
       [](const Invocation&) {
         return configurations([](const std::string& folder) { return folder == "vehicles"; });
       }},
      {"world", [](const Invocation&) { return scenes(); }},
      {"plugin",
       [](const Invocation& invocation) {
         Names names;
         const Registry registry = invocation.registry();
         for (const PluginEntry& entry : registry.entries()) {
           names.push_back(entry.name);
           names.push_back(entry.kind + "/" + entry.name);
         }
         return names;
       }},
      {"utility", [](const Invocation& given) { return plugins_of(given, "utility"); }},
      {"exporter", [](const Invocation& given) { return plugins_of(given, "exporter"); }},
      {"controller", [](const Invocation& given) { return plugins_of(given, "controller"); }},
      {"flight_log", [](const Invocation& given) { return plugins_of(given, "flight_log"); }},
      {"executor", [](const Invocation& given) { return plugins_of(given, "executor"); }},
      {"tour_solver", [](const Invocation& given) { return plugins_of(given, "tour_solver"); }},
      {"plugin_kind", [](const Invocation&) { return templates_in("plugins"); }},
      {"mission_kind", [](const Invocation&) { return templates_in("missions"); }},
      {"schema_kind", [](const Invocation&) {
         Names kinds = templates_in("missions");
         std::erase(kinds, "own");  // has no options of its own
         kinds.push_back("vehicle");
         return kinds;
       }}};
  return all;
}

}  // namespace

const std::vector<NamedValue>& named_values() {
  static const std::vector<NamedValue> all{
      {"", "--config", "config", true},
      {"lapwing verify", "--vehicle", "vehicle", true},
      {"lapwing simulate", "--controller", "controller", false},
      {"lapwing export", "--format", "exporter", false},
      {"lapwing compare", "--format", "flight_log", false},
      {"lapwing log info", "--format", "flight_log", false},
      {"lapwing vehicle from", "--format", "flight_log", false},
      {"lapwing vehicle from", "--base", "vehicle", true},
      {"lapwing scene view", "file", "world", true},
      {"lapwing plugins show", "name", "plugin", false},
      {"lapwing plugins check", "plugin", "plugin", true},
      {"lapwing new plugin", "kind", "plugin_kind", false},
      {"lapwing new mission", "kind", "mission_kind", false},
      {"lapwing schema", "kind", "schema_kind", false},
      {"lapwing run", "--set", kSettings, false},
      {"lapwing config", "--set", kSettings, false},
      {"lapwing sweep", "--set", kSettings, false},
      {"lapwing sweep", "--vary", kSettings, false},
      {"lapwing reproduce", "table", "table", false},
      {"", "--utility", "utility", false},
      {"", "--explorer", "utility", false},
      {"", "--world", "world", true},
      {"", "--executor", "executor", false},
      {"", "--method", "tour_solver", false}};
  return all;
}

std::vector<std::string> name_lists() {
  std::vector<std::string> names;
  for (const auto& [name, list] : lists()) names.push_back(name);
  return names;
}

std::vector<std::string> names_in_list(const std::string& list, const Invocation& invocation) {
  const auto found = lists().find(list);
  if (found == lists().end()) {
    std::string all;
    for (const std::string& name : name_lists()) all += (all.empty() ? "" : ", ") + name;
    throw InputError("there is no list of names '" + list + "'; there are: " + all);
  }
  return without_signs(found->second(invocation));
}

std::string no_scene(const std::string& name) {
  Names known = scenes();
  std::sort(known.begin(), known.end());
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
  const std::string nearest = nearest_name(name, known);
  return "'" + name + "' is not a scene of scripts/scene (" +
         (nearest.empty() ? "" : "did you mean '" + nearest + "'? There are ") + all + ")";
}

std::vector<std::string> settings_of(const std::string& script, const std::string& typed,
                                     const Invocation& invocation) {
  const Registry registry = invocation.registry();
  Invocation quiet = invocation;
  quiet.quiet = true;
  const bool of_value = typed.find('=') != typed.npos;
  Names names;
  for (const SettableOption& option : load_mission(script, quiet, registry)->settable()) {
    if (!of_value) {
      names.push_back(option.key + "=");
      continue;
    }
    for (const std::string& value : option.values) names.push_back(option.key + "=" + value);
    if (!option.vehicle) continue;
    for (const std::string& name : names_in_list("vehicle", invocation))
      names.push_back(option.key + "=" + name);
  }
  std::erase_if(names, [&](const std::string& name) { return !name.starts_with(typed); });
  return without_signs(std::move(names));
}

ExitStatus print_settings(const std::string& script, const std::string& typed,
                          const Invocation& invocation) {
  for (const std::string& name : settings_of(script, typed, invocation)) std::cout << name << "\n";
  return ExitStatus::done;
}

ExitStatus print_names(const std::string& list, const Invocation& invocation) {
  for (const std::string& name : names_in_list(list, invocation)) std::cout << name << "\n";
  return ExitStatus::done;
}

}  // namespace lapwing
