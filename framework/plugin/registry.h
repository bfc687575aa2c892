// SPDX-License-Identifier: Apache-2.0
// Finds plugins on the search path, lists them from their sidecars, opens a library at first use.
//
// A sidecar is `NAME.json` beside `NAME.so`: the descriptors as data, written by the build. Listing
// plugins and checking configuration read sidecars only and load no code (but for a library that is
// newer than its sidecar, which is opened to see whether it still is what the sidecar says). Every
// library is compared with its sidecar when it is first opened. Reads are thread-safe.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "framework/core/parameters.h"
#include "framework/core/plugin_object.h"
#include "framework/plugin/plugin.h"

namespace lapwing {

struct PluginEntry {
  std::string kind;
  std::string name;
  std::string version;
  std::string summary;
  std::string reference;
  std::string preset_of;  // the plugin that this is another name of, or empty
  std::vector<std::string> extensions;
  ParameterTable parameters;  // a preset's defaults are already laid over the plugin's
  std::string abi_tag;
  std::filesystem::path library;
};

class Registry {
 public:
  // Reads every sidecar in `folders` (and one level of sub-folders), first folder first. Throws
  // InputError when two plugins of one kind have one name (naming both files), or a sidecar is
  // malformed or stale. A sidecar without its library, and a JSON file that is no sidecar, are
  // warned of and left out. A folder that does not exist is skipped; one that is named twice is
  // read once.
  explicit Registry(std::vector<std::filesystem::path> folders);
  ~Registry();
  Registry(Registry&&) noexcept;

  const std::vector<std::filesystem::path>& folders() const;
  // Sorted by kind, then name.
  const std::vector<PluginEntry>& entries() const;

  // InputError naming the known names and the nearest one, at `origin`.
  const PluginEntry& find(std::string_view kind, std::string_view name,
                          const Origin& origin = {}) const;

  // Checks `given` (a map of parameters, without `type`) against the plugin's table, opens its
  // library and creates it. Errors: InputError for bad parameters, a library that does not open
  // (with the loader's reason) or has another ABI tag (with both tags and the cure); PluginError
  // when the plugin's own code throws anything but InputError.
  template <class Interface>
  std::unique_ptr<Interface> create(std::string_view name, const Value& given = {},
                                    const std::string& key_path = "") const {
    std::unique_ptr<Interface> created(
        static_cast<Interface*>(create_untyped(Interface::kKind, name, given, key_path)));
    if constexpr (std::is_base_of_v<PluginObject, Interface>)
      created->set_plugin_name(lasting_name(Interface::kKind, name));
    return created;
  }

  // The extension's table, or null.
  const void* extension(std::string_view kind, std::string_view name, std::string_view id) const;

 private:
  void* create_untyped(std::string_view kind, std::string_view name, const Value& given,
                       const std::string& key_path) const;
  // As `lapwing plugins check` takes it: with its kind where another kind has one of that name.
  const char* lasting_name(std::string_view kind, std::string_view name) const;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// --plugin-path folders, LAPWING_PLUGIN_PATH, $XDG_DATA_HOME/lapwing/plugins, then the folder of
// the tree that this library was loaded from: <libdir>/lapwing/plugins of an install, else
// <libdir>/plugins; in this order. InputError when a folder of the command line is none; one of
// LAPWING_PLUGIN_PATH is warned of.
std::vector<std::filesystem::path> plugin_search_path(
    const std::vector<std::filesystem::path>& from_command_line);

// The sidecar text of a library: opens it and dumps its descriptors.
std::string describe_library(const std::filesystem::path& library);

}  // namespace lapwing
