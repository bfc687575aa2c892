// SPDX-License-Identifier: Apache-2.0
// Paths of options, as `--set` names them: "keyframes[2].position", entries counted from 1.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

// A key, or the number of a list's entry where `index` is above 0.
struct PathStep {
  std::string key = {};
  std::size_t index = 0;
  bool operator==(const PathStep&) const = default;
};

using OptionPath = std::vector<PathStep>;

inline constexpr std::size_t kDeepestPath = 32;  // steps

// Throws InputError, its text beginning with the path, where it is malformed or deeper than that.
OptionPath option_path(std::string_view text);
std::string to_text(const OptionPath& path);
// Whether a path can name this key of a map.
bool is_path_key(std::string_view key);

// Whether one of the two is a part of the other, or they are the same.
bool overlap(const OptionPath& a, const OptionPath& b);

// The node at the first `steps` steps of a path; null where there is none.
const Value* find_at(const Value& document, const OptionPath& path, std::size_t steps);

}  // namespace lapwing
