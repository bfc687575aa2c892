// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/binding.h"

#include <algorithm>

#include <lua.hpp>

#include "framework/core/error.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"

namespace lapwing {

namespace {

constexpr const char* kNotesKey = "lapwing.bindings";

BoundType* noted_type(lua_State* state, const char* name) {
  lua_getfield(state, LUA_REGISTRYINDEX, kNotesKey);
  auto* types = static_cast<std::vector<BoundType>*>(lua_touserdata(state, -1));
  lua_pop(state, 1);
  if (!types) return nullptr;
  for (BoundType& type : *types)
    if (type.name == name) return &type;
  types->push_back({name, {}, {}, {}});
  return &types->back();
}

}  // namespace

int index_object(lua_State* state) {
  lua_pushvalue(state, 2);
  if (lua_rawget(state, lua_upvalueindex(1)) != LUA_TNIL) return 1;
  lua_settop(state, 2);
  return lua_tocfunction(state, lua_upvalueindex(2))(state);
}

void note_bindings(lua_State* state, std::vector<BoundType>& types) {
  lua_pushlightuserdata(state, &types);
  lua_setfield(state, LUA_REGISTRYINDEX, kNotesKey);
}

void bind_functions(lua_State* state, const char* type, std::span<const Binding> functions) {
  for (const Binding& binding : functions) {
    lua_pushnil(state);  // an upvalue makes it an object with a number, see sandbox_heap.h
    lua_pushcclosure(state, binding.function, 1);
    lua_setfield(state, -2, binding.name);
  }
  if (BoundType* noted = noted_type(state, type))
    noted->functions.insert(noted->functions.end(), functions.begin(), functions.end());
}

void note_fields(lua_State* state, const char* type, std::span<const BoundField> fields) {
  if (BoundType* noted = noted_type(state, type))
    noted->fields.insert(noted->fields.end(), fields.begin(), fields.end());
}

void note_tables(lua_State* state, const char* type, std::span<const BoundTable> tables) {
  if (BoundType* noted = noted_type(state, type))
    noted->tables.insert(noted->tables.end(), tables.begin(), tables.end());
}

int push_field(lua_State* state, const char* what, std::string_view field, const Value& values,
               std::span<const BoundField> described) {
  const auto is = [&](const std::string& name) {
    return [&](const BoundField& entry) { return name == entry.name; };
  };
  for (const auto& [name, value] : values.as_map())
    if (std::none_of(described.begin(), described.end(), is(name)))
      throw Error(std::string("the field '") + name + "' of " + what + " is not described");
  const Value* found = values.find(field);
  if (!found) {
    std::vector<std::string> known;
    for (const auto& [name, value] : values.as_map()) known.push_back(name);
    const std::string nearest = nearest_name(field, known);
    throw InputError(std::string(what) + " has no field '" + std::string(field) + "'" +
                     (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  push_value(state, *found);
  return 1;
}

Parameters table_argument(lua_State* state, int index, const ParameterTable& table,
                          const std::string& what, std::span<const BoundField> objects) {
  std::vector<std::string_view> without;
  for (const BoundField& object : objects) {
    const std::string_view name = object.name;
    without.push_back(name.ends_with('?') ? name.substr(0, name.size() - 1) : name);
  }
  return table_argument(state, index, table, what, std::span<const std::string_view>(without));
}

}  // namespace lapwing
