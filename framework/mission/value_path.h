// SPDX-License-Identifier: Apache-2.0
// Places in a tree of values, as messages name them: "keyframes[2].time", "" for the whole.
#pragma once

#include <string>
#include <string_view>

#include "framework/core/value.h"

namespace lapwing {

// The value at a path; null where there is none. Entries of a list are counted from 1.
const Value* at_path(const Value& root, std::string_view path);

// The value at the path, or the innermost one around it that is there.
const Value& innermost_at(const Value& root, std::string_view path);

}  // namespace lapwing
