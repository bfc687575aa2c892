// SPDX-License-Identifier: Apache-2.0
// The plugin contract: what a shared library says about itself.
//
// A library exports one C symbol, `lapwing_plugin_library`, written by LAPWING_PLUGINS. It returns
// static data: first the ABI tag, which the loader compares before it touches anything else, then a
// descriptor per plugin. The host owns what `create` returns and deletes it through the interface's
// virtual destructor; a library is never closed, so code and type information outlive every object.
// `create` may be called from any thread; it may throw InputError, and nothing else.
//
//   class KeepLow final : public DifferentiableCost<KeepLow> {
//    public:
//     static constexpr PluginText kText{"keep_low", "1.0.0", "stay below a height", ""};
//     static ParameterTable parameters();
//     explicit KeepLow(const Parameters& parameters);
//     ...
//   };
//   LAPWING_PLUGINS(KeepLow)
//
// A class may have `static std::vector<Preset> presets()`: further names for itself with other
// defaults, as `target_derivative` is `derivative` on block `target`. It may have
// `static std::span<const Extension> extensions()`.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "framework/core/parameters.h"
#include "framework/plugin/abi.h"

namespace lapwing {

struct PluginText {
  const char* name;       // snake_case: folder, file, YAML key, Lua string
  const char* version;    // semantic version of the plugin
  const char* summary;    // one line
  const char* reference;  // paper, section, equation; "" for none
};

// An optional capability, found by its string id ("trainable"); `table` points to static data whose
// type the id fixes.
struct Extension {
  const char* id;
  const void* table;
};

// Another name for a plugin, with other defaults. Not code.
struct Preset {
  std::string name;
  std::string summary;
  Value defaults;  // a map, merged under what the user gives
};

struct PluginDescriptor {
  const char* kind;
  PluginText text;
  ParameterTable (*parameters)();
  void* (*create)(const Parameters&);  // points to the interface of the kind
  std::vector<Preset> (*presets)();
  std::span<const Extension> (*extensions)();
};

struct PluginLibrary {
  const char* abi_tag;
  const PluginDescriptor* descriptors;
  std::size_t count;
};

using PluginLibraryFunction = const PluginLibrary* (*)();
inline constexpr const char* kPluginLibrarySymbol = "lapwing_plugin_library";

// The descriptor of plugin class P, whose interface names its kind in `Interface::kKind`.
template <class P>
PluginDescriptor describe() {
  using Interface = typename P::Interface;
  PluginDescriptor d{};
  d.kind = Interface::kKind;
  d.text = P::kText;
  d.parameters = +[] { return P::parameters(); };
  d.create = +[](const Parameters& parameters) -> void* {
    return static_cast<Interface*>(new P(parameters));
  };
  d.presets = +[]() -> std::vector<Preset> {
    if constexpr (requires { P::presets(); })
      return P::presets();
    else
      return {};
  };
  d.extensions = +[]() -> std::span<const Extension> {
    if constexpr (requires { P::extensions(); })
      return P::extensions();
    else
      return {};
  };
  return d;
}

template <class... Ps>
const PluginLibrary* plugin_library() {
  static const PluginDescriptor descriptors[] = {describe<Ps>()...};
  static const PluginLibrary library{kAbiTag, descriptors, sizeof...(Ps)};
  return &library;
}

}  // namespace lapwing

#define LAPWING_PLUGINS(...)                                                      \
  extern "C" __attribute__((visibility("default"))) const lapwing::PluginLibrary* \
  lapwing_plugin_library() {                                                      \
    return lapwing::plugin_library<__VA_ARGS__>();                                \
  }
