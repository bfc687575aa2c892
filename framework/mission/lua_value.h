// SPDX-License-Identifier: Apache-2.0
// Between Lua's tables and the neutral tree of core/value.h.
//
// A table whose keys are 1..n is a list, one with texts as keys a map (its keys sorted, because Lua
// keeps no order), an empty one an empty list, which `check` takes for an empty map as well. Tables
// do not remember their lines: every node gets the origin given, that of the call that took it.
#pragma once

#include <Eigen/Core>
#include <lua.hpp>

#include <span>
#include <string>
#include <string_view>

#include "framework/core/value.h"

namespace lapwing {

// InputError at `origin` naming the key path for functions, objects, mixed tables, tables that hold
// themselves, nesting deeper than 32, NaN and infinities. Keys in `without` are left out at the
// top.
Value value_from_lua(lua_State* state, int index, const Origin& origin,
                     const std::string& key_path = "",
                     std::span<const std::string_view> without = {});

// InputError where the script's limit of memory has no room for the copies that a mission's options
// become: as given, laid over one another, checked, in the plan.
void claim_copies(lua_State* state, const Value& options);

void push_value(lua_State* state, const Value& value);

// {x, y, z}.
inline Value list_of(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

}  // namespace lapwing
