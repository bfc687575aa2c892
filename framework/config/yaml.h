// SPDX-License-Identifier: Apache-2.0
// YAML text to Value. The one place that includes yaml-cpp.
//
// What is read is YAML 1.2's core: maps with text keys, lists, and scalars. A plain scalar is null,
// true or false, an integer, a number, or else a text; a quoted one is a text. What YAML offers
// beyond that (anchors, aliases, merge keys, tags, several documents) is refused by name, because
// no reader of a configuration should have to expand it in their head.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "framework/core/value.h"

namespace lapwing {

inline constexpr std::size_t kMaximumYamlBytes = 4u << 20;
inline constexpr std::size_t kMaximumYamlDepth = 64;

// An empty text is an empty map. Every node's origin is `source` and its line, from 1; a map or
// list has the line of the key that it belongs to. Throws InputError: for bad syntax,
// "source:line:column: what"; for repeated keys, numbers that are not finite and refused features,
// all of them together.
Value from_yaml(std::string_view text, const std::string& source);

// Reads a file; its path, as given, is the source. Throws InputError as above, or when it cannot be
// read.
Value read_yaml(const std::filesystem::path& file);

}  // namespace lapwing
