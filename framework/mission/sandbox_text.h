// SPDX-License-Identifier: Apache-2.0
// Texts of values, in which no address of memory stands.
#pragma once

#include <string>
#include <string_view>

struct lua_State;

namespace lapwing {

// Pushes the text of the value at `index` as luaL_tolstring does; tables, functions, userdata and
// threads show the number that they got when they were made: "table: 0x00000017".
void push_described(lua_State* state, int index);

// tostring(v), print(...) and string.format, whose %s and %p show the same. `format` expects
// Lua's own as its first upvalue.
int described(lua_State* state);
int print_described(lua_State* state);
int format_described(lua_State* state);

// A text as messages can carry it: NUL as \0, and no more of it than a reader wants.
std::string as_message(std::string_view text);

}  // namespace lapwing
