// SPDX-License-Identifier: Apache-2.0
// The edits of a studio as a configuration beside the script: NAME.studio.yaml.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "framework/core/value.h"

namespace lapwing {

// "shots/castle.studio.yaml" of "shots/castle.lua", and likewise with other endings.
std::filesystem::path beside_script(const std::filesystem::path& script, const char* ending);

// The file's text: comments with revision and checksums, then the layer. Lists of the layer stand
// in place of the script's, whose checksum is said.
std::string layer_text(const std::filesystem::path& script, std::uint64_t revision,
                       const Value& layer, const Value& script_options);

// Writes it whole; a layer without edits is taken away. InputError where it cannot.
void write_layer(const std::filesystem::path& script, std::uint64_t revision, const Value& layer,
                 const Value& script_options);

struct LayerFile {
  Value layer = Value::map();
  bool as_written = false;  // by a studio, and not changed since
};
// None where there is none. InputError as `read_yaml`.
std::optional<LayerFile> read_layer(const std::filesystem::path& script);

}  // namespace lapwing
