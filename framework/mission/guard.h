// SPDX-License-Identifier: Apache-2.0
// The border between Lua and C++: no exception crosses it unseen.
//
// Lua here is built with C++ exceptions, so its own errors unwind C++ frames properly; they are
// pointers to a private type and pass through `catch (const std::exception&)`. A C++ exception that
// reached Lua would lose its message, so every function given to Lua is wrapped in `guarded`.
#pragma once

#include <lua.hpp>

#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "framework/core/error.h"
#include "framework/mission/binding.h"
#include "framework/mission/sandbox.h"

namespace lapwing {

// Pushes the message that an InputError becomes: as it is when it begins with a place
// ("shot.lua:3: ..."), else with the script's position before it.
void push_input_error(lua_State* state, const InputError& error);

// Keeps a defect for Sandbox::protect to throw again, and pushes its message.
void push_defect(lua_State* state, const std::exception& error);

template <int (*Function)(lua_State*)>
int guarded(lua_State* state) {
  try {
    return Function(state);
  } catch (const InputError& error) {
    push_input_error(state, error);
  } catch (const std::exception& error) {
    push_defect(state, error);
  }
  return lua_error(state);
}

inline void push_text(lua_State* state, std::string_view text) {
  lua_pushlstring(state, text.data(), text.size());
}

// The argument as text; InputError says what was expected.
std::string text_argument(lua_State* state, int index, const char* what);

// An object of C++ held by Lua: destroyed by its finaliser, its metatable out of scripts' reach.
template <class T>
int destroy_object(lua_State* state) {
  static_cast<T*>(lua_touserdata(state, 1))->~T();
  return 0;
}

// Leaves the new object on the stack. `type_name` is that given to `define_type`.
template <class T>
T& new_object(lua_State* state, const char* type_name, T value) {
  void* memory = lua_newuserdatauv(state, sizeof(T), 0);
  T* object = new (memory) T(std::move(value));
  luaL_setmetatable(state, type_name);
  return *object;
}

// What a type's __index asks: its methods (upvalue 1), then the function of its fields (upvalue 2).
int index_object(lua_State* state);

// Declares a type: its methods, and optionally an __index function that is asked where there is no
// such method. `type_name` is what error messages call it.
template <class T>
void define_type(lua_State* state, const char* type_name, BindingLists methods,
                 lua_CFunction fields = nullptr) {
  luaL_newmetatable(state, type_name);
  lua_pushcfunction(state, &destroy_object<T>);
  lua_setfield(state, -2, "__gc");
  lua_pushliteral(state, "protected");
  lua_setfield(state, -2, "__metatable");
  lua_newtable(state);
  for (const std::span<const Binding> list : methods) bind_functions(state, type_name, list);
  if (fields) {
    lua_pushcfunction(state, fields);
    lua_pushcclosure(state, &index_object, 2);
  }
  lua_setfield(state, -2, "__index");
  lua_pop(state, 1);
}

template <class T>
T* test_object(lua_State* state, int index, const char* type_name) {
  return static_cast<T*>(luaL_testudata(state, index, type_name));
}

// InputError when the value is something else.
template <class T>
T& object_argument(lua_State* state, int index, const char* type_name) {
  if (T* object = test_object<T>(state, index, type_name)) return *object;
  throw InputError(std::string("expected a ") + type_name + ", got " + luaL_typename(state, index));
}

}  // namespace lapwing
