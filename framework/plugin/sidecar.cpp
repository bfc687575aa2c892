// SPDX-License-Identifier: Apache-2.0
#include "framework/plugin/sidecar.h"

#include <algorithm>
#include <set>

#include "framework/core/active_call.h"
#include "framework/core/json.h"
#include "framework/plugin/library.h"

namespace lapwing {

namespace {

constexpr int kSidecarVersion = 1;

bool is_snake_case(std::string_view name) {
  if (name.empty() || name.front() < 'a' || name.front() > 'z') return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

std::string text_or_empty(const char* text) {
  return text ? text : "";
}

Value describe_presets(const PluginDescriptor& descriptor, const ParameterTable& table) {
  Value list = Value::list();
  for (const Preset& preset : descriptor.presets()) {
    with_defaults(table, preset.defaults, preset.name);  // refuses what the table lacks
    Value map = Value::map();
    map.set("name", preset.name);
    map.set("summary", preset.summary);
    map.set("defaults", preset.defaults.is_null() ? Value::map() : preset.defaults);
    list.push_back(std::move(map));
  }
  return list;
}

Value describe_plugin(const PluginDescriptor& descriptor) {
  const std::string name = text_or_empty(descriptor.text.name);
  const ActiveCall mark(lasting_text(name), "describe");
  Value map = Value::map();
  map.set("kind", text_or_empty(descriptor.kind));
  map.set("name", name);
  map.set("version", text_or_empty(descriptor.text.version));
  map.set("summary", text_or_empty(descriptor.text.summary));
  map.set("reference", text_or_empty(descriptor.text.reference));
  const ParameterTable table = call_plugin(name, "parameters", descriptor.parameters);
  map.set("parameters", table.to_value());
  map.set("presets",
          call_plugin(name, "presets", [&] { return describe_presets(descriptor, table); }));
  Value& extensions = map.set("extensions", Value::list());
  for (const Extension& extension : call_plugin(name, "extensions", descriptor.extensions)) {
    extensions.push_back(text_or_empty(extension.id));
  }
  return map;
}

void require_name(const Value& map, const char* key) {
  const Value& name = map.at(key);
  if (is_snake_case(name.as_text())) return;
  throw InputError(name.origin(),
                   std::string(key) + " '" + name.as_text() + "' of a plugin is not in snake_case");
}

PluginEntry entry_from_value(const Value& map) {
  require_name(map, "kind");
  require_name(map, "name");
  PluginEntry entry;
  entry.kind = map.at("kind").as_text();
  entry.name = map.at("name").as_text();
  entry.version = map.at("version").as_text();
  entry.summary = map.at("summary").as_text();
  entry.reference = map.at("reference").as_text();
  if (entry.summary.empty() || entry.summary.find('\n') != std::string::npos) {
    throw InputError(map.origin(), "the summary of '" + entry.name + "' is not one line");
  }
  for (const Value& id : map.at("extensions").as_list()) entry.extensions.push_back(id.as_text());
  entry.parameters = ParameterTable::from_value(map.at("parameters"));
  return entry;
}

PluginEntry preset_entry(const PluginEntry& plugin, const Value& map) {
  require_name(map, "name");
  PluginEntry entry = plugin;
  entry.preset_of = plugin.name;
  entry.name = map.at("name").as_text();
  entry.summary = map.at("summary").as_text();
  entry.parameters = with_defaults(plugin.parameters, map.at("defaults"), entry.name);
  return entry;
}

}  // namespace

ParameterTable with_defaults(const ParameterTable& table, const Value& defaults,
                             const std::string& key_path) {
  Value list = table.to_value();
  if (defaults.is_null()) return table;
  for (const auto& [key, value] : defaults.as_map()) {
    const ParameterSpec* spec = table.find(key);
    const std::string path = key_path + "." + key;
    if (!spec) throw InputError(value.origin(), path + ": a preset of a key that does not exist");
    for (Value& map : list.as_list()) {
      if (map.at("name").as_text() != key) continue;
      if (spec->type == ParameterType::table) {
        map.set("table", with_defaults(*spec->table, value, path).to_value());
      } else {
        Value only = Value::list();
        only.push_back(map);
        Value given = Value::map();
        given.set(key, value);
        map.set("default",
                check(ParameterTable::from_value(only), given, key_path).value().at(key));
        map.set("required", false);
      }
    }
  }
  return ParameterTable::from_value(list);
}

Value describe_as_value(const std::filesystem::path& library) {
  const PluginLibrary& opened = open_library(library);
  Value map = Value::map();
  map.set("sidecar", kSidecarVersion);
  map.set("library", library.filename().string());
  map.set("abi_tag", opened.abi_tag);
  Value& plugins = map.set("plugins", Value::list());
  for (std::size_t i = 0; i < opened.count; ++i) {
    plugins.push_back(describe_plugin(opened.descriptors[i]));
  }
  entries_from_sidecar(map, library);  // refuses what no host would read back
  return map;
}

std::string describe_library(const std::filesystem::path& library) {
  return to_json(describe_as_value(library)) + "\n";
}

std::vector<PluginEntry> entries_from_sidecar(const Value& sidecar,
                                              const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    throw InputError("malformed plugin sidecar '" + file.string() + "': " + why);
  };
  std::vector<PluginEntry> entries;
  try {
    if (sidecar.at("sidecar").as_integer() != kSidecarVersion) {
      throw InputError(sidecar.at("sidecar").origin(),
                       "this host reads sidecars of version " + std::to_string(kSidecarVersion));
    }
    const std::filesystem::path library = sidecar.at("library").as_text();
    if (library.empty() || library != library.filename()) {
      throw InputError(sidecar.at("library").origin(), "'library' is not a plain file name");
    }
    for (const Value& map : sidecar.at("plugins").as_list()) {
      const PluginEntry plugin = entry_from_value(map);
      entries.push_back(plugin);
      for (const Value& preset : map.at("presets").as_list()) {
        entries.push_back(preset_entry(plugin, preset));
      }
    }
    for (PluginEntry& entry : entries) {
      entry.abi_tag = sidecar.at("abi_tag").as_text();
      entry.library = file.parent_path() / library;
    }
  } catch (const InputError& error) {
    refuse(error.what());
  }
  if (entries.empty()) refuse("it names no plugin");
  std::set<std::pair<std::string, std::string>> seen;
  for (const PluginEntry& entry : entries) {
    if (!seen.emplace(entry.kind, entry.name).second) {
      refuse("it names " + entry.kind + " '" + entry.name + "' twice");
    }
  }
  return entries;
}

}  // namespace lapwing
