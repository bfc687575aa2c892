// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/sandbox_order.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "framework/mission/guard.h"

namespace lapwing {

namespace {

constexpr const char* kOrders = "lapwing.orders";  // in the registry: table -> its keys in order

// What decides where a key stands. Texts point into Lua and live as long as their key.
struct OrderedKey {
  int rank = 0;
  bool whole = false;  // a number: which of the two fields holds it
  double number = 0;
  std::int64_t integer = 0;  // or the number of an object
  std::string_view text;
  lua_Integer place = 0;  // in the list of keys as they came
};

int rank_of(int type) {
  switch (type) {
    case LUA_TNUMBER:
      return 0;
    case LUA_TSTRING:
      return 1;
    default:
      return 1 + type;  // boolean, table, function, userdata, thread: in Lua's own numbering
  }
}

OrderedKey key_at(lua_State* state, int index) {
  OrderedKey key;
  const int type = lua_type(state, index);
  key.rank = rank_of(type);
  if (type == LUA_TNUMBER) {
    key.whole = lua_isinteger(state, index);
    if (key.whole)
      key.integer = lua_tointeger(state, index);
    else
      key.number = lua_tonumber(state, index);
  } else if (type == LUA_TSTRING) {
    std::size_t length = 0;
    const char* text = lua_tolstring(state, index, &length);
    key.text = {text, length};
  } else if (type == LUA_TBOOLEAN) {
    key.integer = lua_toboolean(state, index);
  } else {
    key.integer = static_cast<std::int64_t>(Sandbox::of(state).heap().number_of(state, index));
  }
  return key;
}

// Exact, where a double would make 2^53 and 2^53 + 1 equal. No whole number comes as a double.
bool whole_before(std::int64_t whole, double number) {
  if (number >= 0x1p63) return true;
  if (number < -0x1p63) return false;
  return whole <= static_cast<std::int64_t>(std::floor(number));
}

bool number_before(const OrderedKey& a, const OrderedKey& b) {
  if (a.whole && b.whole) return a.integer < b.integer;
  if (!a.whole && !b.whole) return a.number < b.number;
  return a.whole ? whole_before(a.integer, b.number) : !whole_before(b.integer, a.number);
}

bool key_before(const OrderedKey& a, const OrderedKey& b) {
  if (a.rank != b.rank) return a.rank < b.rank;
  if (a.rank == 0) return number_before(a, b);
  if (a.rank == 1) return a.text < b.text;
  return a.integer < b.integer;
}

bool same_key(const OrderedKey& a, const OrderedKey& b) {
  return !key_before(a, b) && !key_before(b, a);
}

[[noreturn]] void refuse_unordered() {
  throw InputError(
      "pairs, next: two keys are built-in functions of Lua without a number (such as the one "
      "that "
      "ipairs returns); their order would differ from run to run. Keep the keys in a list as well");
}

// Two functions of C without upvalues have no number: alone one may stand, two may not.
void require_order(const OrderedKey& a, const OrderedKey& b) {
  if (a.rank > 1 && same_key(a, b)) refuse_unordered();
}

// Pushes a list of the keys of the table at `table` in order, with their number at [0].
void push_ordered_keys(lua_State* state, int table) {
  lua_Integer count = 0;
  lua_pushnil(state);
  while (lua_next(state, table)) {
    lua_pop(state, 1);
    ++count;
  }
  lua_createtable(state, static_cast<int>(std::min<lua_Integer>(count, 1 << 26)), 1);
  const int ordered = lua_gettop(state);
  // Lua's own memory, so that the limit counts it.
  auto* const keys = static_cast<OrderedKey*>(
      lua_newuserdatauv(state, sizeof(OrderedKey) * static_cast<std::size_t>(count), 0));
  lua_createtable(state, static_cast<int>(std::min<lua_Integer>(count, 1 << 26)), 0);
  const int found = lua_gettop(state);
  lua_Integer place = 0;
  lua_pushnil(state);
  while (lua_next(state, table)) {
    lua_pop(state, 1);
    keys[place] = key_at(state, -1);
    keys[place].place = place + 1;
    lua_pushvalue(state, -1);
    lua_rawseti(state, found, ++place);
  }
  std::sort(keys, keys + count, key_before);
  for (lua_Integer i = 0; i < count; ++i) {
    if (i > 0) require_order(keys[i - 1], keys[i]);
    lua_rawgeti(state, found, keys[i].place);
    lua_rawseti(state, ordered, i + 1);
  }
  lua_pushinteger(state, count);
  lua_rawseti(state, ordered, 0);
  lua_settop(state, ordered);
  Sandbox::of(state).check_clock(state);
}

lua_Integer key_count(lua_State* state, int list) {
  lua_rawgeti(state, list, 0);
  const lua_Integer value = lua_tointeger(state, -1);
  lua_pop(state, 1);
  return value;
}

OrderedKey listed(lua_State* state, int list, lua_Integer place) {
  lua_rawgeti(state, list, place);
  const OrderedKey key = key_at(state, -1);
  lua_pop(state, 1);
  return key;
}

// upvalues: keys in order, how many have been visited
int next_pair(lua_State* state) {
  lua_settop(state, 1);
  for (;;) {
    const lua_Integer visited = lua_tointeger(state, lua_upvalueindex(2)) + 1;
    lua_pushinteger(state, visited);
    lua_copy(state, -1, lua_upvalueindex(2));
    lua_settop(state, 1);
    if (lua_rawgeti(state, lua_upvalueindex(1), visited) == LUA_TNIL) return 1;
    lua_pushvalue(state, -1);
    if (lua_rawget(state, 1) != LUA_TNIL) return 2;
    lua_settop(state, 1);  // removed meanwhile
  }
}

// The table of orders, its keys held weakly.
void push_orders(lua_State* state) {
  if (lua_getfield(state, LUA_REGISTRYINDEX, kOrders) == LUA_TTABLE) return;
  lua_pop(state, 1);
  lua_newtable(state);
  lua_newtable(state);
  lua_pushliteral(state, "k");
  lua_setfield(state, -2, "__mode");
  lua_setmetatable(state, -2);
  lua_pushvalue(state, -1);
  lua_setfield(state, LUA_REGISTRYINDEX, kOrders);
}

void forget_order(lua_State* state) {
  push_orders(state);
  lua_pushvalue(state, 1);
  lua_pushnil(state);
  lua_rawset(state, -3);
  lua_pop(state, 1);
}

// next(t): the least key, without sorting.
int first_pair(lua_State* state) {
  forget_order(state);
  lua_settop(state, 1);
  lua_pushnil(state);  // 2, 3: the least so far and its value
  lua_pushnil(state);
  OrderedKey least, doubtful;
  bool any = false, doubt = false;
  lua_pushnil(state);
  while (lua_next(state, 1)) {
    const OrderedKey key = key_at(state, -2);
    if (any && !key_before(key, least)) {
      if (same_key(key, least)) doubtful = key, doubt = true;
    } else {
      any = true;
      least = key;
      lua_copy(state, -2, 2);
      lua_copy(state, -1, 3);
    }
    lua_pop(state, 1);
  }
  if (doubt) require_order(doubtful, least);
  Sandbox::of(state).check_clock(state);
  lua_settop(state, 3);
  return any ? 2 : 1;
}

// Leaves the order of the table at 1 at 3: the one kept, or a new one.
void push_order(lua_State* state, bool anew) {
  lua_settop(state, 2);
  push_orders(state);
  lua_pushvalue(state, 1);
  if (anew || lua_rawget(state, -2) == LUA_TNIL) {
    lua_pop(state, 1);
    push_ordered_keys(state, 1);
    lua_pushvalue(state, 1);
    lua_pushvalue(state, -2);
    lua_rawset(state, -4);
  }
  lua_remove(state, 3);
}

// The first place in the order at 3 whose key does not come before `key`.
lua_Integer place_of(lua_State* state, const OrderedKey& key) {
  lua_Integer low = 1, high = key_count(state, 3) + 1;
  while (low < high) {
    const lua_Integer middle = low + (high - low) / 2;
    if (key_before(listed(state, 3, middle), key))
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

}  // namespace

int ordered_pairs(lua_State* state) {
  if (luaL_getmetafield(state, 1, "__pairs") != LUA_TNIL) {
    lua_pushvalue(state, 1);
    lua_call(state, 1, 3);
    return 3;
  }
  luaL_checktype(state, 1, LUA_TTABLE);
  lua_settop(state, 1);
  push_ordered_keys(state, 1);
  lua_pushinteger(state, 0);
  lua_pushcclosure(state, &next_pair, 2);
  lua_pushvalue(state, 1);
  lua_pushnil(state);
  return 3;
}

int ordered_next(lua_State* state) {
  luaL_checktype(state, 1, LUA_TTABLE);
  lua_settop(state, 2);
  if (lua_isnil(state, 2)) return first_pair(state);
  if (lua_type(state, 2) == LUA_TNUMBER && std::isnan(lua_tonumber(state, 2)))
    return luaL_error(state, "invalid key to 'next'");
  // A whole number that comes as a float is the integer, as it is as a key.
  int exact = 0;
  const lua_Integer whole = lua_tointegerx(state, 2, &exact);
  if (exact && lua_type(state, 2) == LUA_TNUMBER) {
    lua_pushinteger(state, whole);
    lua_replace(state, 2);
  }
  const OrderedKey key = key_at(state, 2);
  push_order(state, false);
  lua_Integer place = place_of(state, key);
  const bool known = place <= key_count(state, 3) && same_key(listed(state, 3, place), key);
  if (!known) {  // added since, or removed before this order was made
    push_order(state, true);
    place = place_of(state, key);
  }
  const lua_Integer count = key_count(state, 3);
  if (place <= count && same_key(listed(state, 3, place), key)) ++place;
  for (; place <= count; ++place) {
    lua_settop(state, 3);
    lua_rawgeti(state, 3, place);
    lua_pushvalue(state, -1);
    if (lua_rawget(state, 1) != LUA_TNIL) return 2;
  }
  forget_order(state);
  lua_pushnil(state);
  return 1;
}

}  // namespace lapwing
