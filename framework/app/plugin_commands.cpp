// SPDX-License-Identifier: Apache-2.0
// lapwing plugins list, show and path. Reads sidecars; loads no code.
#include <cstdio>
#include <iostream>

#include "framework/app/command_line.h"
#include "framework/app/descriptions.h"
#include "framework/core/json.h"

namespace lapwing {

namespace {

Value plugin_value(const PluginEntry& entry, bool with_parameters) {
  Value object = Value::map();
  object.set("kind", entry.kind);
  object.set("name", entry.name);
  object.set("version", entry.version);
  object.set("summary", entry.summary);
  object.set("reference", entry.reference);
  if (!entry.preset_of.empty()) object.set("preset_of", entry.preset_of);
  object.set("library", entry.library.string());
  if (with_parameters) {
    Value& declares = object.set("declares", Value::list());
    for (const std::string& id : entry.extensions) declares.push_back(id);
    object.set("parameters", entry.parameters.to_value());
  }
  return object;
}

std::string default_text(const ParameterSpec& spec) {
  if (spec.required) return "required";
  if (spec.type == ParameterType::table || spec.type == ParameterType::tables) return "";
  return spec.default_value.is_null() ? "optional" : "default " + to_json(spec.default_value, -1);
}

void print_parameters(const ParameterTable& table, int indent) {
  for (const ParameterSpec& spec : table.specs()) {
    std::string kind = spec.type_name();
    if (!spec.unit.empty()) kind += ", " + spec.unit;
    if (const std::string range = spec.range.to_string(); !range.empty()) kind += ", " + range;
    const std::string fallback = default_text(spec);
    if (!fallback.empty()) kind += ", " + fallback;
    std::printf("%*s%-*s %s (%s)\n", indent, "", 24 - indent, spec.name.c_str(),
                spec.summary.c_str(), kind.c_str());
    if (spec.type == ParameterType::choice) {
      std::string choices;
      for (const std::string& choice : spec.choices) {
        choices += (choices.empty() ? "" : ", ") + choice;
      }
      std::printf("%*sone of %s\n", 25, "", choices.c_str());
    }
    if (spec.table) print_parameters(*spec.table, indent + 2);
  }
}

void print_plugin(const PluginEntry& entry) {
  std::printf("%s %s %s\n  %s\n", entry.kind.c_str(), entry.name.c_str(), entry.version.c_str(),
              entry.summary.c_str());
  if (!entry.reference.empty()) std::printf("  after %s\n", entry.reference.c_str());
  if (!entry.preset_of.empty()) {
    std::printf("  another name of %s, with other defaults\n", entry.preset_of.c_str());
  }
  if (!entry.extensions.empty()) {
    std::string all;
    for (const std::string& id : entry.extensions) all += (all.empty() ? "" : ", ") + id;
    std::printf("  declares: %s\n", all.c_str());
  }
  std::printf("  %s\n", entry.library.c_str());
  if (entry.parameters.specs().empty()) {
    std::printf("parameters: none\n");
  } else {
    std::printf("parameters:\n");
    print_parameters(entry.parameters, 2);
  }
}

}  // namespace

void refuse_unknown_plugin(const Registry& registry, const std::string& name) {
  std::vector<std::string> names;
  for (const PluginEntry& entry : registry.entries()) {
    names.push_back(entry.name);
    names.push_back(entry.kind + "/" + entry.name);
  }
  const std::string nearest = nearest_name(name, names);
  throw InputError(
      "there is no plugin '" + name + "'" +
      (nearest.empty() ? "; see 'lapwing plugins list'" : "; did you mean '" + nearest + "'?") +
      "; --plugin-path FOLDER adds a folder of your plugins");
}

ExitStatus list_plugins(const Invocation& invocation) {
  const Registry registry = invocation.registry();
  if (invocation.json) {
    Value list = Value::list();
    for (const PluginEntry& entry : registry.entries()) {
      list.push_back(plugin_value(entry, false));
    }
    Value object = Value::map();
    object.set("plugins", std::move(list));
    print_json(object);
    return ExitStatus::done;
  }
  std::string kind;
  for (const PluginEntry& entry : registry.entries()) {
    if (entry.kind != kind) std::printf("%s\n", entry.kind.c_str());
    kind = entry.kind;
    std::printf("  %-20s %-7s %s\n", entry.name.c_str(), entry.version.c_str(),
                entry.summary.c_str());
  }
  if (registry.entries().empty()) std::printf("no plugins; see 'lapwing plugins path'\n");
  return ExitStatus::done;
}

ExitStatus show_plugin(const std::string& name, bool markdown, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  std::vector<const PluginEntry*> found;
  for (const PluginEntry& entry : registry.entries()) {
    if (entry.name == name || entry.kind + "/" + entry.name == name) found.push_back(&entry);
  }
  if (found.empty()) refuse_unknown_plugin(registry, name);
  if (invocation.json) {
    Value list = Value::list();
    for (const PluginEntry* entry : found) list.push_back(plugin_value(*entry, true));
    Value object = Value::map();
    object.set("plugins", std::move(list));
    print_json(object);
    return ExitStatus::done;
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0) std::printf("\n");
    if (markdown)
      std::printf("%s", parameters_as_markdown(*found[i]).c_str());
    else
      print_plugin(*found[i]);
  }
  return ExitStatus::done;
}

ExitStatus show_plugin_path(const Invocation& invocation) {
  Value list = Value::list();
  for (const std::filesystem::path& folder : plugin_search_path(invocation.plugin_path)) {
    if (invocation.json) {
      list.push_back(folder.string());
    } else {
      std::printf("%s%s\n", folder.c_str(),
                  std::filesystem::is_directory(folder) ? "" : "  (no such folder)");
    }
  }
  if (invocation.json) {
    Value object = Value::map();
    object.set("folders", std::move(list));
    print_json(object);
  }
  return ExitStatus::done;
}

}  // namespace lapwing
