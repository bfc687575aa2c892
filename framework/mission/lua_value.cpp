#include "framework/mission/lua_value.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "framework/core/json.h"
#include "framework/mission/guard.h"

namespace lapwing {

namespace {

constexpr int kDeepest = 32;

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
      case LUA_TSTRING: {
        std::size_t length = 0;
        const char* text = lua_tolstring(state_, index, &length);
        return located(read_text(std::string(text, length), path));
      }
      case LUA_TTABLE:
        return read_table(index, path, without);
      default:
        refuse(path, std::string("a ") + luaL_typename(state_, index) + " cannot stand here");
    }
  }

 private:
  Value located(Value value) const {
    value.with_origin(origin_);
    return value;
  }

  [[noreturn]] void refuse(const std::string& path, const std::string& message) const {
    throw InputError(origin_, path.empty() ? message : path + ": " + message);
  }

  // Texts end up in JSON, which is UTF-8.
  Value read_text(std::string text, const std::string& path) const {
    try {
      to_json(Value(text));
    } catch (const Error&) {
      refuse(path, "expected text in UTF-8");
    }
    return Value(std::move(text));
  }

  Value read_number(int index, const std::string& path) const {
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
      refuse(path, "a table that holds itself cannot stand here");
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
    if (entries_ != length)
      refuse(path, "a list with gaps, or numbered from something else than 1");
    Value list = Value::list();
    for (lua_Integer i = 1; i <= length; ++i) {
      lua_rawgeti(state_, index, i);
      list.push_back(read(-1, path + "[" + std::to_string(i) + "]"));
      lua_pop(state_, 1);
    }
    return list;
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
        keys.emplace_back(lua_tostring(state_, -1));
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
};

}  // namespace

Value value_from_lua(lua_State* state, int index, const Origin& origin, const std::string& key_path,
                     std::span<const std::string_view> without) {
  return Reader(state, origin).read(index, key_path, without);
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
