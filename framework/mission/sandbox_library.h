// The functions of Lua's own libraries that a script may use, some of them wrapped.
#pragma once

struct lua_State;

namespace lapwing {

// Sets up the global table. `pairs` goes through keys in order (numbers, then texts), because Lua's
// own order changes from run to run.
void open_allowed_libraries(lua_State* state);

// Steps that matching `pattern` somewhere in a subject of `length` characters takes at the worst.
double worst_pattern_steps(const char* pattern, std::size_t pattern_length, std::size_t length,
                           bool caret_anchors);

}  // namespace lapwing
