// SPDX-License-Identifier: Apache-2.0
// The functions of Lua's own libraries that a script may use, some of them wrapped.
#pragma once

struct lua_State;

namespace lapwing {

// Sets up the global table. Whatever would differ from run to run is replaced: the order of `pairs`
// and `next` (sandbox_order.h), addresses in texts (sandbox_text.h), `table.sort` (sandbox_sort.h).
void open_allowed_libraries(lua_State* state);

// Steps that matching `pattern` somewhere in a subject of `length` characters takes at the worst.
double worst_pattern_steps(const char* pattern, std::size_t pattern_length, std::size_t length,
                           bool caret_anchors);

}  // namespace lapwing
