// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/lua_value.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "framework/core/json.h"
#include "framework/mission/guard.h"
#include "framework/mission/symbolic_values.h"

namespace lapwing {

namespace {

constexpr int kDeepest = 32;
constexpr std::size_t kLongestKey = 1000;   // bytes
constexpr std::size_t kCopies = 4;          // of a text, on its way from Lua into a plan
constexpr std::size_t kClaimed = 1u << 20;  // bytes of values, before the limit is asked again

class Reader {
 public:
  Reader(lua_State* state, const Origin& origin) : state_(state), origin_(origin) {}

  Value read(int index, const std::string& path, std::span<const std::string_view> without = {}) {
    index = lua_absindex(state_, index);
    switch (lua_type(state_, index)) {
      case LUA_TNIL:
        return located(Value());
      case LUA_TBOOLEAN:
        return located(Value(static_cast<bool>(lua_toboolean(state_, index))));
      case LUA_TNUMBER:
        return read_number(index, path);
      case LUA_TSTRING:
        return located(Value(text_at(index, path)));
      case LUA_TTABLE:
        return read_table(index, path, without);
      default:
        if (is_symbolic_vector(state_, index)) return read_vector(index, path);
        refuse(path, std::string("a ") + luaL_typename(state_, index) + " is not allowed here");
    }
  }

 private:
  Value located(Value value) {
    value.with_origin(origin_);
    hold(sizeof(Value) + origin_.source.size());
    return value;
  }

  // Values are held outside of Lua, and count as the script's memory all the same.
  void hold(std::size_t bytes) {
    held_ += bytes;
    if (held_ < claimed_) return;
    Sandbox::of(state_).claim(state_, held_);
    claimed_ = held_ + kClaimed;
  }

  [[noreturn]] void refuse(const std::string& path, const std::string& message) const {
    throw InputError(origin_, path.empty() ? message : path + ": " + message);
  }

  // Texts end up in JSON, which is UTF-8, and in names, which a NUL would cut.
  std::string text_at(int index, const std::string& path) {
    std::size_t length = 0;
    const char* const text = lua_tolstring(state_, index, &length);
    hold(kCopies * length);
    const std::string_view view(text, length);
    if (!is_utf8(view)) refuse(path, "expected text in UTF-8");
    if (view.find('\0') != view.npos)
      refuse(path, "a text with a NUL character is not allowed here");
    return std::string(view);
  }

  Value read_number(int index, const std::string& path) {
    if (lua_isinteger(state_, index)) {
      return located(Value(static_cast<std::int64_t>(lua_tointeger(state_, index))));
    }
    const double number = lua_tonumber(state_, index);
    if (std::isnan(number)) refuse(path, "expected a finite number, got NaN");
    if (std::isinf(number)) refuse(path, "expected a finite number, got an infinity");
    return located(Value(number));
  }

  Value read_table(int index, const std::string& path, std::span<const std::string_view> without) {
    const void* identity = lua_topointer(state_, index);
    if (std::find(open_.begin(), open_.end(), identity) != open_.end()) {
      refuse(path, "a table that contains itself is not allowed here");
    }
    if (open_.size() >= kDeepest) refuse(path, "tables nested more than 32 deep");
    luaL_checkstack(state_, 8, "nested tables");
    open_.push_back(identity);
    const std::vector<std::string> keys = text_keys(index, path);
    const lua_Integer length = static_cast<lua_Integer>(lua_rawlen(state_, index));
    Value result = keys.empty() ? read_list(index, length, path) : Value::map();
    if (!keys.empty() && entries_ != static_cast<lua_Integer>(keys.size())) {
      refuse(path, "a table with both numbered and named entries ('" + keys.front() + "')");
    }
    for (const std::string& key : keys) {
      if (std::find(without.begin(), without.end(), key) != without.end()) continue;
      push_text(state_, key);
      lua_rawget(state_, index);
      result.set(key, read(-1, path.empty() ? key : path + "." + key));
      lua_pop(state_, 1);
    }
    open_.pop_back();
    return located(std::move(result));
  }

  Value read_list(int index, lua_Integer length, const std::string& path) {
    if (entries_ != length) refuse(path, "a list with gaps, or not numbered from 1");
    Value list = Value::list();
    for (lua_Integer i = 1; i <= length; ++i) {
      lua_rawgeti(state_, index, i);
      list.push_back(read(-1, path + "[" + std::to_string(i) + "]"));
      lua_pop(state_, 1);
    }
    return list;
  }

  // A lapwing.vector is the list of its numbers.
  Value read_vector(int index, const std::string& path) {
    Value list = Value::list();
    for (const SymbolicScalar& entry : symbolic_vector_argument(state_, index, path)) {
      if (!entry.known())
        refuse(path,
               "a value of a stage is unknown until the problem is solved: it is not allowed "
               "here");
      if (!std::isfinite(entry.value)) refuse(path, "expected a vector of finite numbers");
      list.push_back(located(Value(entry.value)));
    }
    return located(std::move(list));
  }

  // Sorted; counts all entries into entries_.
  std::vector<std::string> text_keys(int index, const std::string& path) {
    std::vector<std::string> keys;
    lua_Integer entries = 0;
    lua_pushnil(state_);
    while (lua_next(state_, index)) {
      lua_pop(state_, 1);
      ++entries;
      if (lua_type(state_, -1) == LUA_TSTRING) {
        if (lua_rawlen(state_, -1) > kLongestKey)
          refuse(path, "a name of more than " + std::to_string(kLongestKey) + " bytes");
        keys.push_back(text_at(-1, path));
      } else if (!lua_isinteger(state_, -1)) {
        refuse(path, std::string("keys must be texts or 1, 2, 3, ..., not a ") +
                         luaL_typename(state_, -1));
      }
    }
    entries_ = entries;
    std::sort(keys.begin(), keys.end());
    return keys;
  }

  lua_State* state_;
  Origin origin_;
  std::vector<const void*> open_;
  lua_Integer entries_ = 0;
  std::size_t held_ = 0, claimed_ = kClaimed;  // bytes
};

}  // namespace

Value value_from_lua(lua_State* state, int index, const Origin& origin, const std::string& key_path,
                     std::span<const std::string_view> without) {
  return Reader(state, origin).read(index, key_path, without);
}

namespace {

// Without the texts, whose copies were claimed as they were read.
std::size_t size_of(const Value& value) {
  std::size_t bytes = sizeof(Value) + value.origin().source.size();
  if (value.is_list())
    for (const Value& entry : value.as_list()) bytes += size_of(entry);
  if (value.is_map())
    for (const auto& [key, entry] : value.as_map()) bytes += sizeof key + size_of(entry);
  return bytes;
}

}  // namespace

void claim_copies(lua_State* state, const Value& options) {
  Sandbox::of(state).claim(state, kCopies * size_of(options));
}

void push_value(lua_State* state, const Value& value) {
  luaL_checkstack(state, 4, "nested values");
  switch (value.type()) {
    case Value::Type::null:
      lua_pushnil(state);
      return;
    case Value::Type::boolean:
      lua_pushboolean(state, value.as_boolean());
      return;
    case Value::Type::integer:
      lua_pushinteger(state, value.as_integer());
      return;
    case Value::Type::number:
      lua_pushnumber(state, value.as_number());
      return;
    case Value::Type::text:
      push_text(state, value.as_text());
      return;
    case Value::Type::list: {
      lua_createtable(state, static_cast<int>(value.as_list().size()), 0);
      lua_Integer place = 0;
      for (const Value& entry : value.as_list()) {
        push_value(state, entry);
        lua_rawseti(state, -2, ++place);
      }
      return;
    }
    case Value::Type::map:
      lua_createtable(state, 0, static_cast<int>(value.as_map().size()));
      for (const auto& [key, entry] : value.as_map()) {
        push_text(state, key);
        push_value(state, entry);
        lua_rawset(state, -3);
      }
      return;
  }
}

}  // namespace lapwing
