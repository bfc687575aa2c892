// SPDX-License-Identifier: Apache-2.0
// Sidecars: what a plugin library says about itself, as a JSON file beside it.
//
// {"sidecar": 1, "library": "NAME.so", "abi_tag": "...", "plugins": [{"kind", "name", "version",
//  "summary", "reference", "parameters": [...], "presets": [{"name", "summary", "defaults"}],
//  "extensions": ["id"]}]}
#pragma once

#include <filesystem>
#include <vector>

#include "framework/core/value.h"
#include "framework/plugin/registry.h"

namespace lapwing {

// Opens the library and dumps its descriptors. InputError when it does not open, or says something
// of itself that the contract forbids; PluginError when its code throws.
Value describe_as_value(const std::filesystem::path& library);

// The entries of a sidecar that was read from `file`, presets included, each named as a plugin of
// its own. InputError, with file and line, when it is malformed.
std::vector<PluginEntry> entries_from_sidecar(const Value& sidecar,
                                              const std::filesystem::path& file);

// `table` with the values of `defaults` (a map) in place of its own defaults. InputError naming the
// key that the table lacks or whose value it refuses.
ParameterTable with_defaults(const ParameterTable& table, const Value& defaults,
                             const std::string& key_path);

}  // namespace lapwing
