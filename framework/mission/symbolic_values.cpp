// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/symbolic_values.h"

#include "framework/mission/guard.h"

namespace lapwing {

namespace {

// Error messages of Lua itself show this name, so it says where to go.
constexpr const char* kScalarType = "value of a stage (which the functions of `lapwing` take)";
constexpr const char* kVectorType = "vector";
constexpr const char* kSettingKey = "lapwing.symbolic_setting";

struct ScalarObject {
  int node = -1;
  std::uint64_t serial = 0;
};

struct VectorObject {
  SymbolicEntries entries;
  std::uint64_t serial = 0;  // 0: all entries are known
};

// Errors of a name that is two things.
void expect_current(lua_State* state, std::uint64_t serial) {
  const SymbolicSetting* setting = symbolic_setting(state);
  if (serial == 0 || (setting && setting->serial == serial)) return;
  refuse_symbolic(state,
                  "a value of a stage was kept from another term or another call; it means "
                  "nothing outside of the function that it was given to");
}

bool is_list_of_numbers(lua_State* state, int index) {
  return lua_istable(state, index) || is_symbolic_vector(state, index);
}

enum class SymbolicOperator { add, subtract, multiply, divide };

constexpr const char* sign_of(SymbolicOperator op) {
  return op == SymbolicOperator::add        ? "+"
         : op == SymbolicOperator::subtract ? "-"
         : op == SymbolicOperator::multiply ? "*"
                                            : "/";
}

template <SymbolicOperator kOperator>
int symbolic_arithmetic(lua_State* state) {
  constexpr TapeOp kOps[] = {TapeOp::add, TapeOp::subtract, TapeOp::multiply, TapeOp::divide};
  constexpr TapeOp kOp = kOps[static_cast<int>(kOperator)];
  const std::string what = std::string("'") + sign_of(kOperator) + "'";
  const bool first = is_list_of_numbers(state, 1), second = is_list_of_numbers(state, 2);
  if (!first && !second) {
    push_symbolic(state,
                  symbolic_result(symbolic_setting(state), kOp, symbolic_argument(state, 1, what),
                                  symbolic_argument(state, 2, what)));
    return 1;
  }
  SymbolicEntries result;
  if (kOp == TapeOp::add || kOp == TapeOp::subtract) {
    if (!first || !second)
      refuse_symbolic(state, what + " of " + describe_symbolic(state, 1) + " and " +
                                 describe_symbolic(state, 2) +
                                 ": both must be vectors, or both "
                                 "numbers; v.x is one number of a vector");
    result = symbolic_vector_argument(state, 1, what);
    const SymbolicEntries other = symbolic_vector_argument(state, 2, what);
    if (result.size() != other.size())
      refuse_symbolic(state, what + " of " + describe_symbolic(state, 1) + " and " +
                                 describe_symbolic(state, 2) + ": their sizes differ");
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = symbolic_result(symbolic_setting(state), kOp, result[i], other[i]);
  } else {
    if (first && second)
      refuse_symbolic(state, what +
                                 " of two vectors: write lapwing.dot(a, b), lapwing.cross(a, b) "
                                 "or take their numbers, a.x " +
                                 sign_of(kOperator) + " b.x");
    if (kOp == TapeOp::divide && second)
      refuse_symbolic(state, "a number divided by a vector has no meaning here");
    result = symbolic_vector_argument(state, first ? 1 : 2, what);
    const SymbolicScalar factor = symbolic_argument(state, first ? 2 : 1, what);
    for (SymbolicScalar& entry : result)
      entry = symbolic_result(symbolic_setting(state), kOp, entry, factor);
  }
  push_symbolic_vector(state, std::move(result));
  return 1;
}

int symbolic_negated(lua_State* state) {
  if (!is_list_of_numbers(state, 1)) {
    push_symbolic(state, symbolic_result(symbolic_setting(state), TapeOp::negate,
                                         symbolic_argument(state, 1, "'-'")));
    return 1;
  }
  SymbolicEntries result = symbolic_vector_argument(state, 1, "'-'");
  for (SymbolicScalar& entry : result)
    entry = symbolic_result(symbolic_setting(state), TapeOp::negate, entry);
  push_symbolic_vector(state, std::move(result));
  return 1;
}

int symbolic_power_of(lua_State* state) {
  const SymbolicScalar base = symbolic_argument(state, 1, "'^'");
  const SymbolicScalar exponent = symbolic_argument(state, 2, "'^'");
  push_symbolic(state, at_this_line(state, [&] {
                  return symbolic_power(symbolic_setting(state), base, exponent);
                }));
  return 1;
}

int refuse_comparison(lua_State* state) {
  refuse_symbolic(state,
                  "a comparison would decide once, while the function is recorded, and not at "
                  "every stage: write lapwing.where(x, a, b), which is a where x > 0 and b "
                  "elsewhere, or lapwing.max, lapwing.min, lapwing.abs");
}
int refuse_remainder(lua_State* state) {
  refuse_symbolic(state,
                  "'%' and '//' jump and have no derivative; write what you mean with "
                  "lapwing.where, lapwing.sin or lapwing.cos");
}
int refuse_text(lua_State* state) {
  refuse_symbolic(state,
                  "a value of a stage cannot be joined to a text: it is a formula and has "
                  "no value yet");
}
int refuse_assignment(lua_State* state) {
  refuse_symbolic(state,
                  "vectors and values of a stage cannot be changed; write "
                  "lapwing.vector(x, y, z) to make another vector");
}

std::string key_text(lua_State* state, int index) {
  return lua_type(state, index) == LUA_TSTRING ? lua_tostring(state, index)
                                               : describe_symbolic(state, index);
}

int scalar_index(lua_State* state) {
  refuse_symbolic(state, "this is one number and has no '" + key_text(state, 2) + "'");
}
int scalar_text(lua_State* state) {
  push_text(state, "value of a stage");
  return 1;
}

int vector_index(lua_State* state) {
  const VectorObject& vector = object_argument<VectorObject>(state, 1, kVectorType);
  expect_current(state, vector.serial);
  const auto size = static_cast<lua_Integer>(vector.entries.size());
  lua_Integer at = 0;
  if (lua_type(state, 2) == LUA_TNUMBER && lua_isinteger(state, 2)) {
    at = lua_tointeger(state, 2);
    lua_Debug caller;
    const bool by_lua = lua_getstack(state, 1, &caller) && lua_getinfo(state, "S", &caller) &&
                        std::string_view(caller.what) != "C";
    if (at == size + 1 && !by_lua) {  // where ipairs ends
      lua_pushnil(state);
      return 1;
    }
  } else if (lua_type(state, 2) == LUA_TSTRING) {
    const std::string key = lua_tostring(state, 2);
    at = key == "x" ? 1 : key == "y" ? 2 : key == "z" ? 3 : 0;
  }
  if (at < 1 || at > size)
    refuse_symbolic(state, "a vector of " + std::to_string(size) + " numbers has no '" +
                               (lua_isinteger(state, 2) ? std::to_string(lua_tointeger(state, 2))
                                                        : key_text(state, 2)) +
                               "'; it has " + (size <= 3 ? "x, y, z, or " : "") + "1 to " +
                               std::to_string(size));
  push_symbolic(state, vector.entries[at - 1]);
  return 1;
}

int vector_length(lua_State* state) {
  const VectorObject& vector = object_argument<VectorObject>(state, 1, kVectorType);
  lua_pushinteger(state, static_cast<lua_Integer>(vector.entries.size()));
  return 1;
}
int vector_text(lua_State* state) {
  push_text(state, describe_symbolic(state, 1));
  return 1;
}

template <class T>
void define_operators(lua_State* state, const char* type, lua_CFunction index,
                      const luaL_Reg* more) {
  const luaL_Reg operators[] = {
      {"__add", &guarded<symbolic_arithmetic<SymbolicOperator::add>>},
      {"__sub", &guarded<symbolic_arithmetic<SymbolicOperator::subtract>>},
      {"__mul", &guarded<symbolic_arithmetic<SymbolicOperator::multiply>>},
      {"__div", &guarded<symbolic_arithmetic<SymbolicOperator::divide>>},
      {"__unm", &guarded<symbolic_negated>},
      {"__pow", &guarded<symbolic_power_of>},
      {"__lt", &guarded<refuse_comparison>},
      {"__le", &guarded<refuse_comparison>},
      {"__eq", &guarded<refuse_comparison>},
      {"__mod", &guarded<refuse_remainder>},
      {"__idiv", &guarded<refuse_remainder>},
      {"__concat", &guarded<refuse_text>},
      {"__newindex", &guarded<refuse_assignment>},
      {nullptr, nullptr}};
  define_type<T>(state, type, {}, index);
  luaL_getmetatable(state, type);
  luaL_setfuncs(state, operators, 0);
  luaL_setfuncs(state, more, 0);
  lua_pop(state, 1);
}

}  // namespace

SymbolicSetting* symbolic_setting(lua_State* state) {
  lua_getfield(state, LUA_REGISTRYINDEX, kSettingKey);
  auto* setting = static_cast<SymbolicSetting*>(lua_touserdata(state, -1));
  lua_pop(state, 1);
  return setting;
}

void set_symbolic_setting(lua_State* state, SymbolicSetting* setting) {
  if (setting)
    lua_pushlightuserdata(state, setting);
  else
    lua_pushnil(state);
  lua_setfield(state, LUA_REGISTRYINDEX, kSettingKey);
}

void refuse_symbolic(lua_State* state, const std::string& message) {
  const SymbolicSetting* setting = symbolic_setting(state);
  const std::string text = setting ? setting->what + ": " + message : message;
  lua_Debug record;
  for (int level = 0; lua_getstack(state, level, &record); ++level) {
    lua_getinfo(state, "Sl", &record);
    if (record.currentline > 0 && record.source[0] == '@')
      throw InputError(Origin{record.source + 1, record.currentline}, text);
  }
  throw InputError(text);
}

void push_symbolic(lua_State* state, const SymbolicScalar& scalar) {
  if (scalar.known())
    lua_pushnumber(state, scalar.value);
  else
    new_object(state, kScalarType, ScalarObject{scalar.node, symbolic_setting(state)->serial});
}

void push_symbolic_vector(lua_State* state, SymbolicEntries entries) {
  std::uint64_t serial = 0;
  for (const SymbolicScalar& entry : entries)
    if (!entry.known()) serial = symbolic_setting(state)->serial;
  new_object(state, kVectorType, VectorObject{std::move(entries), serial});
}

bool is_symbolic_scalar(lua_State* state, int index) {
  return lua_type(state, index) == LUA_TNUMBER ||
         test_object<ScalarObject>(state, index, kScalarType);
}

bool is_symbolic_vector(lua_State* state, int index) {
  return test_object<VectorObject>(state, index, kVectorType);
}

std::string describe_symbolic(lua_State* state, int index) {
  if (is_symbolic_scalar(state, index)) return "a number";
  if (const auto* vector = test_object<VectorObject>(state, index, kVectorType))
    return "a vector of " + std::to_string(vector->entries.size()) + " numbers";
  switch (lua_type(state, index)) {
    case LUA_TNIL:
    case LUA_TNONE:
      return "nothing";
    case LUA_TBOOLEAN:
      return "a truth value";
    case LUA_TTABLE:
      return "a list of " + std::to_string(lua_rawlen(state, index));
    default:
      break;
  }
  std::string type = luaL_typename(state, index);
  if (luaL_getmetafield(state, index, "__name") == LUA_TSTRING) {
    type = lua_tostring(state, -1);
    lua_pop(state, 1);
  }
  return "a " + type;
}

SymbolicScalar symbolic_argument(lua_State* state, int index, const std::string& what) {
  if (lua_type(state, index) == LUA_TNUMBER) return {.value = lua_tonumber(state, index)};
  if (const auto* scalar = test_object<ScalarObject>(state, index, kScalarType)) {
    expect_current(state, scalar->serial);
    return {.value = 0, .node = scalar->node};
  }
  refuse_symbolic(state, what + ": expected a number, got " + describe_symbolic(state, index));
}

SymbolicEntries symbolic_vector_argument(lua_State* state, int index, const std::string& what,
                                         int size) {
  SymbolicEntries entries;
  if (const auto* vector = test_object<VectorObject>(state, index, kVectorType)) {
    expect_current(state, vector->serial);
    entries = vector->entries;
  } else if (lua_istable(state, index)) {
    const auto count = static_cast<lua_Integer>(lua_rawlen(state, index));
    for (lua_Integer i = 1; i <= count; ++i) {
      lua_rawgeti(state, index, i);
      entries.push_back(
          symbolic_argument(state, lua_gettop(state), what + "[" + std::to_string(i) + "]"));
      lua_pop(state, 1);
    }
  } else {
    refuse_symbolic(state, what + ": expected a vector, got " + describe_symbolic(state, index));
  }
  if (entries.empty() || (size > 0 && static_cast<int>(entries.size()) != size))
    refuse_symbolic(state, what + ": expected a vector of " +
                               (size > 0 ? std::to_string(size) : std::string("some")) +
                               " numbers, got " + describe_symbolic(state, index));
  return entries;
}

void open_symbolic_types(lua_State* state) {
  const luaL_Reg of_scalar[] = {{"__tostring", &guarded<scalar_text>}, {nullptr, nullptr}};
  define_operators<ScalarObject>(state, kScalarType, &guarded<scalar_index>, of_scalar);
  const luaL_Reg of_vector[] = {{"__len", &guarded<vector_length>},
                                {"__tostring", &guarded<vector_text>},
                                {nullptr, nullptr}};
  define_operators<VectorObject>(state, kVectorType, &guarded<vector_index>, of_vector);
  static constexpr const char* kValue = "lapwing.value";
  static constexpr const char* kVector = "lapwing.symbolic_vector";
  static constexpr BoundField kOfScalar[] = {{"operator add(lapwing.value)", kValue, "sum"},
                                             {"operator sub(lapwing.value)", kValue, "difference"},
                                             {"operator mul(lapwing.value)", kValue, "product"},
                                             {"operator div(lapwing.value)", kValue, "quotient"},
                                             {"operator pow(number)", kValue, "power"},
                                             {"operator unm", kValue, "negative"}};
  static constexpr BoundField kOfVector[] = {
      {"x", kValue, "first entry"},
      {"y", kValue, "second entry"},
      {"z", kValue, "third entry"},
      {"[integer]", kValue, "any entry, from 1"},
      {"operator add(lapwing.vector)", kVector, "sum"},
      {"operator sub(lapwing.vector)", kVector, "difference"},
      {"operator mul(lapwing.value)", kVector, "scaled"},
      {"operator div(lapwing.value)", kVector, "scaled"},
      {"operator unm", kVector, "negative"}};
  note_fields(state, "scalar", kOfScalar);
  note_fields(state, "symbolic vector", kOfVector);
}

}  // namespace lapwing
