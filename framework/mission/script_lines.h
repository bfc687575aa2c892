// SPDX-License-Identifier: Apache-2.0
// On which lines of a script the fields of a table are written, so that an error of an option names
// its own line and not that of the call.
//
// Lua forgets where a field was written; the text tells wherever the table stands in it as a
// constructor, `film.shot { margin = 0.6 }`. A table that is built in steps keeps the line of the
// call.
#pragma once

#include <string_view>

#include "framework/core/value.h"

namespace lapwing {

// `given` was given to a call on line `line` of a script with this text: the first constructor of
// that line which is an argument tells the lines of its values. A literal there that differs from
// the value is another table's: the value keeps its origin.
void locate_argument(Value& given, std::string_view text, int line);

// The same of field `field` of the table that the script returns by its last `return { ... }`.
void locate_in_result(Value& given, std::string_view text, std::string_view field);

}  // namespace lapwing
