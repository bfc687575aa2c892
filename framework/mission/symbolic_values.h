// SPDX-License-Identifier: Apache-2.0
// Numbers and vectors that the function of a cost term or constraint computes with.
//
// While a term is recorded they are nodes of an expression; when its recording is checked they are
// plain numbers. The same operators and functions (`lapwing.sin`, `lapwing.max`, ...) take both, so
// that the function need not know. What Lua lets a type trap is trapped: comparing, joining to a
// text or cutting to whole numbers is an error that says what to write instead.
#pragma once

#include <lua.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "framework/problem/expression_graph.h"

namespace lapwing {

// A number: known, or a node of the recording under way.
struct SymbolicScalar {
  double value = 0;
  int node = -1;
  bool known() const { return node < 0; }
};
using SymbolicEntries = std::vector<SymbolicScalar>;

// The recording under way. Values are worth nothing in another one: `serial` tells them apart.
struct SymbolicSetting {
  std::string what;  // "cost 'keep_low'", for messages
  double width = 0;  // within which kinks are rounded
  std::uint64_t serial = 0;
  ExpressionGraph graph;
};

// Null where none is under way: functions then take plain numbers alone, and kinks are exact.
SymbolicSetting* symbolic_setting(lua_State* state);
void set_symbolic_setting(lua_State* state, SymbolicSetting* setting);

// InputError at the line of Lua that is being run, beginning with what is being recorded.
[[noreturn]] void refuse_symbolic(lua_State* state, const std::string& message);

// An operation; carried out at once where all operands are known.
SymbolicScalar symbolic_result(lua_State* state, TapeOp op, const SymbolicScalar& a,
                               const SymbolicScalar& b = {}, const SymbolicScalar& c = {},
                               double number = 0, int data = 0);
// The node of a number, known or not.
int symbolic_node(SymbolicSetting& setting, const SymbolicScalar& scalar);

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
