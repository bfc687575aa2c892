// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/sandbox_sort.h"

#include <algorithm>
#include <numeric>

#include "framework/mission/guard.h"

namespace lapwing {

namespace {

// Positions on the stack.
constexpr int kTable = 1, kBefore = 2, kEntries = 3;

// Whether entry `a` comes before entry `b`, by the script's function or by Lua's `<`.
bool entry_before(lua_State* state, int a, int b) {
  const bool own = !lua_isnil(state, kBefore);
  if (own) lua_pushvalue(state, kBefore);
  lua_rawgeti(state, kEntries, a + 1);
  lua_rawgeti(state, kEntries, b + 1);
  if (own) lua_call(state, 2, 1);
  const bool result = own ? lua_toboolean(state, -1) : lua_compare(state, -2, -1, LUA_OPLT);
  lua_pop(state, own ? 1 : 2);
  return result;
}

// Merges the sorted runs [low, middle) and [middle, high) of `from` into `to`.
void merge_runs(lua_State* state, const int* from, int* to, int low, int middle, int high) {
  int left = low, right = middle;
  for (int at = low; at < high; ++at) {
    const bool take_right =
        left == middle || (right < high && entry_before(state, from[right], from[left]));
    to[at] = take_right ? from[right++] : from[left++];
  }
}

// Sorts `order`, whose second half is room to work in. Written out, because the library's sort may
// run out of its range where a comparison contradicts itself.
const int* merge_sort(lua_State* state, int* order, int count) {
  int* from = order;
  int* to = order + count;
  for (int width = 1; width<count; width = width> count / 2 ? count : 2 * width) {
    for (int low = 0; low < count; low += 2 * std::min(width, count - low)) {
      const int middle = low + std::min(width, count - low);
      merge_runs(state, from, to, low, middle, middle + std::min(width, count - middle));
    }
    std::swap(from, to);
    Sandbox::of(state).check_clock(state);
  }
  return from;
}

}  // namespace

int stable_sort(lua_State* state) {
  luaL_checktype(state, kTable, LUA_TTABLE);
  lua_settop(state, 2);
  if (!lua_isnil(state, kBefore)) luaL_checktype(state, kBefore, LUA_TFUNCTION);
  if (luaL_getmetafield(state, kTable, "__len") != LUA_TNIL)
    throw InputError("table.sort: the table has a __len of its own");
  const lua_Unsigned length = lua_rawlen(state, kTable);
  if (length > kLargestSort)
    throw InputError("table.sort: more than " + std::to_string(kLargestSort) + " entries");
  const int count = static_cast<int>(length);
  lua_createtable(state, count, 0);
  for (int i = 1; i <= count; ++i) {
    lua_geti(state, kTable, i);
    lua_rawseti(state, kEntries, i);
  }
  // Lua's own memory, so that an error leaves nothing behind and the limit counts it.
  const std::size_t bytes = 2 * sizeof(int) * static_cast<std::size_t>(count);
  auto* const order = static_cast<int*>(lua_newuserdatauv(state, bytes, 0));
  std::iota(order, order + count, 0);
  const int* const sorted = merge_sort(state, order, count);
  for (int i = 0; i < count; ++i) {
    lua_rawgeti(state, kEntries, sorted[i] + 1);
    lua_seti(state, kTable, i + 1);
  }
  return 0;
}

}  // namespace lapwing
