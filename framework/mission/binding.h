// SPDX-License-Identifier: Apache-2.0
// What scripts are given, and what is said of it: one list serves the interpreter, the annotations
// for editors and the README's table.
//
// A signature is written as LuaLS writes one: "(plan: lapwing.plan, words?: string): number". The
// type `@` is the class of the binding's own table, which has the table's entries and `objects`.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/parameters.h"

struct lua_State;

namespace lapwing {

// A value by name: a field of an object, or a key of a table that is no plain data.
struct BoundField {
  const char* name;     // of a key that may be left out: with '?' at its end
  const char* type;     // as LuaLS writes it
  const char* summary;  // one line
};

struct Binding {
  const char* name;
  int (*function)(lua_State*);  // guarded
  const char* signature;
  const char* summary;                    // one line
  ParameterTable (*table)() = nullptr;    // of the argument of type `@`
  std::span<const BoundField> objects{};  // keys of that argument that the table lacks
};

// A table that scripts write and no function alone is the owner of.
struct BoundTable {
  const char* name;
  ParameterTable (*table)();
  std::span<const BoundField> objects{};
};

// A type of object, or the table `lapwing`.
struct BoundType {
  std::string name;  // as error messages show it: "problem"
  std::vector<Binding> functions;
  std::vector<BoundField> fields;
  std::vector<BoundTable> tables;
};

using BindingLists = std::vector<std::span<const Binding>>;

// Sets the functions in the Lua table on top of the stack, and notes them as part of the type.
void bind_functions(lua_State* state, const char* type, std::span<const Binding> functions);
void note_fields(lua_State* state, const char* type, std::span<const BoundField> fields);
void note_tables(lua_State* state, const char* type, std::span<const BoundTable> tables);

// From here on what is bound to this state is noted in `types`, which outlives it.
void note_bindings(lua_State* state, std::vector<BoundType>& types);

// Pushes the entry `field` of `values` (a map), which holds what `described` names and nothing else
// (Error). InputError for an unknown field: "a plan has no field 'tme'; did you mean 'time'?"
int push_field(lua_State* state, const char* what, std::string_view field, const Value& values,
               std::span<const BoundField> described);

// The table argument at `index` but for the keys of `objects`, checked; `table()` may be null.
Parameters table_argument(lua_State* state, int index, const ParameterTable& table,
                          const std::string& what, std::span<const BoundField> objects);

}  // namespace lapwing
