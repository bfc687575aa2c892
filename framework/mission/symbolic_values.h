// SPDX-License-Identifier: Apache-2.0
// The symbolic numbers (symbolic/symbolic_number.h) as scripts have them: what the function of a
// cost term or constraint computes with.
//
// While a term is recorded they are nodes of an expression; when its recording is checked they are
// plain numbers. The same operators and functions (`lapwing.sin`, `lapwing.max`, ...) take both, so
// that the function need not know. What Lua lets a type trap is trapped: comparing, joining to a
// text or cutting to whole numbers is an error that says what to write instead.
#pragma once

#include <lua.hpp>

#include <string>

#include "framework/core/error.h"
#include "framework/symbolic/symbolic_number.h"

namespace lapwing {

// Null where none is under way: functions then take plain numbers alone, and kinks are exact.
SymbolicSetting* symbolic_setting(lua_State* state);
void set_symbolic_setting(lua_State* state, SymbolicSetting* setting);

// InputError at the line of Lua that is being run, beginning with what is being recorded.
[[noreturn]] void refuse_symbolic(lua_State* state, const std::string& message);

// InputErrors of the kernel, said at the line of Lua that is being run.
template <class Body>
decltype(auto) at_this_line(lua_State* state, Body&& body) {
  std::string message;
  try {
    return body();
  } catch (const InputError& error) {
    message = error.what();
  }
  refuse_symbolic(state, message);
}

void push_symbolic(lua_State* state, const SymbolicScalar& scalar);
void push_symbolic_vector(lua_State* state, SymbolicEntries entries);

// Whether the value is a number or a symbolic one.
bool is_symbolic_scalar(lua_State* state, int index);
bool is_symbolic_vector(lua_State* state, int index);
// The value; an error, beginning with `what`, when it is something else.
SymbolicScalar symbolic_argument(lua_State* state, int index, const std::string& what);
// A vector or a list of numbers. `size` 0: any.
SymbolicEntries symbolic_vector_argument(lua_State* state, int index, const std::string& what,
                                         int size = 0);
// "a number", "a vector of 3 numbers", "a string", ...
std::string describe_symbolic(lua_State* state, int index);

// Adds the types; the functions, to the table `lapwing`.
void open_symbolic_types(lua_State* state);
void open_symbolic_functions(lua_State* state);

}  // namespace lapwing
