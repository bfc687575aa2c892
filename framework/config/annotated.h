// SPDX-License-Identifier: Apache-2.0
// Effective values as YAML that says where each came from.
#pragma once

#include <string>

#include "framework/core/value.h"

namespace lapwing {

// One leaf a line, each with a comment: "# from shot.lua:12", "# --set" or "# default", aligned in
// a column; none where the origin is not known. A list without maps in it stays on one line, and
// its comment names every source of its entries. Reading the text back as YAML gives equal values,
// unless long lists are shortened: then a list of more than 100 tables or lists under a key becomes
// a comment with count, first and last entry.
enum class LongLists { whole, shortened };
std::string annotated_yaml(const Value& value, LongLists lists = LongLists::whole);

}  // namespace lapwing
