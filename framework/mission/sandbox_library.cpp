// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/sandbox_library.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "framework/mission/guard.h"
#include "framework/mission/sandbox_order.h"
#include "framework/mission/sandbox_sort.h"
#include "framework/mission/sandbox_text.h"

namespace lapwing {

namespace {

constexpr lua_Integer kLongestRange = 10'000'000;  // entries that one table function may go through

// Calls the function that a wrapper stands for, with the wrapper's own arguments and in its frame,
// so that messages name it as the script does.
int call_original(lua_State* state) {
  const int results = lua_tocfunction(state, lua_upvalueindex(1))(state);
  Sandbox::of(state).check_clock(state);
  return results;
}

// The same for a function that has upvalues of its own.
int call_closure(lua_State* state) {
  const int arguments = lua_gettop(state);
  lua_pushvalue(state, lua_upvalueindex(1));
  lua_insert(state, 1);
  lua_call(state, arguments, LUA_MULTRET);
  Sandbox::of(state).check_clock(state);
  return lua_gettop(state);
}

// -- strings
// ---------------------------------------------------------------------------------------

void check_pattern(lua_State* state, const char* function, bool caret_anchors) {
  if (lua_type(state, 2) != LUA_TSTRING || !lua_isstring(state, 1)) return;  // Lua's own message
  std::size_t length = 0, pattern_length = 0;
  lua_tolstring(state, 1, &length);
  const char* pattern = lua_tolstring(state, 2, &pattern_length);
  const double steps = worst_pattern_steps(pattern, pattern_length, length, caret_anchors);
  if (steps <= Sandbox::of(state).limits().pattern_work) return;
  throw InputError(std::string("string.") + function +
                   ": a pattern with this many repetitions on " + std::to_string(length) +
                   " characters could run too long; anchor it with ^, shorten the text, or raise "
                   "sandbox.pattern_work");
}

int find(lua_State* state) {
  if (!lua_toboolean(state, 4)) check_pattern(state, "find", true);
  return call_original(state);
}

int match(lua_State* state) {
  check_pattern(state, "match", true);
  return call_original(state);
}

int gsub(lua_State* state) {
  check_pattern(state, "gsub", true);
  return call_original(state);
}

int gmatch(lua_State* state) {
  check_pattern(state, "gmatch", false);
  const int results = call_original(state);
  lua_pushvalue(state, -results);
  lua_replace(state, 1);
  lua_settop(state, 1);
  lua_pushcclosure(state, &guarded<call_closure>, 1);
  return 1;
}

int rep(lua_State* state) {
  std::size_t length = 0, separator = 0;
  if (lua_isstring(state, 1)) lua_tolstring(state, 1, &length);
  if (lua_isstring(state, 3)) lua_tolstring(state, 3, &separator);
  const lua_Integer count = lua_tointegerx(state, 2, nullptr);  // 2^31 and "9" count too
  if (count > kLongestRange && length + separator == 0) {
    throw InputError("string.rep: more than " + std::to_string(kLongestRange) + " repetitions");
  }
  return call_original(state);
}

// -- tables
// ----------------------------------------------------------------------------------------

// insert, remove, sort and the defaults of the others ask for the length, which a metamethod may
// make up.
void check_plain_length(lua_State* state, const char* function, lua_Integer limit) {
  if (lua_istable(state, 1) && luaL_getmetafield(state, 1, "__len") != LUA_TNIL) {
    throw InputError(std::string("table.") + function + ": the table has a __len of its own");
  }
  if (lua_istable(state, 1) && static_cast<lua_Integer>(lua_rawlen(state, 1)) > limit) {
    throw InputError(std::string("table.") + function + ": more than " + std::to_string(limit) +
                     " entries");
  }
}

void check_range(lua_State* state, const char* function, int first, int last) {
  // As Lua itself reads them: 2^31 and "9" are counts too.
  int is_count = 0, has_start = 0;
  const lua_Integer to = lua_tointegerx(state, last, &is_count);
  if (!is_count) return;
  const lua_Integer start = lua_tointegerx(state, first, &has_start);
  const double count = static_cast<double>(to) - static_cast<double>(has_start ? start : 1);
  if (count > static_cast<double>(kLongestRange)) {
    throw InputError(std::string("table.") + function + ": more than " +
                     std::to_string(kLongestRange) + " entries");
  }
}

int insert(lua_State* state) {
  check_plain_length(state, "insert", kLongestRange);
  return call_original(state);
}

int remove(lua_State* state) {
  check_plain_length(state, "remove", kLongestRange);
  return call_original(state);
}

int concat(lua_State* state) {
  check_plain_length(state, "concat", kLongestRange);
  check_range(state, "concat", 3, 4);
  return call_original(state);
}

int unpack(lua_State* state) {
  check_plain_length(state, "unpack", kLongestRange);
  check_range(state, "unpack", 2, 3);
  return call_original(state);
}

int move(lua_State* state) {
  check_range(state, "move", 2, 3);
  return call_original(state);
}

// -- base
// ------------------------------------------------------------------------------------------

// A finaliser would run with the limits off.
int set_metatable(lua_State* state) {
  if (lua_istable(state, 2)) {
    lua_pushliteral(state, "__gc");
    if (lua_rawget(state, 2) != LUA_TNIL) {
      throw InputError("setmetatable: finalisers (__gc) are not allowed here");
    }
    lua_pop(state, 1);
  }
  return call_original(state);
}

int require(lua_State* state) {
  Sandbox::of(state).require(state, text_argument(state, 1, "require"));
  return 1;
}

// -- math
// ------------------------------------------------------------------------------------------

int random(lua_State* state) {
  Random& random = Sandbox::of(state).random();
  const int arguments = lua_gettop(state);
  if (arguments == 0) {
    lua_pushnumber(state, random.uniform());
    return 1;
  }
  const lua_Integer low = arguments == 1 ? 1 : luaL_checkinteger(state, 1);
  const lua_Integer high = luaL_checkinteger(state, arguments == 1 ? 1 : 2);
  luaL_argcheck(state, low <= high, arguments == 1 ? 1 : 2, "interval is empty");
  lua_pushinteger(state, random.integer(low, high));
  return 1;
}

int refuse_seed(lua_State*) {
  throw InputError("math.randomseed: the run seeds random numbers; use --seed");
}

// An error that the limits raise comes out of a hook, and until it is caught hooks stay off: a
// message handler, or a to-be-closed variable of a coroutine that died of it, would run without
// limits. So xpcall calls its handler after unwinding, and coroutine.wrap leaves dead coroutines as
// they are.
constexpr const char* kPrelude = R"(
local pcall, error, create, resume = pcall, error, coroutine.create, coroutine.resume
function xpcall(f, handler, ...)
  local function finish(done, ...)
    if done then return true, ... end
    return false, handler(...)
  end
  return finish(pcall(f, ...))
end
function coroutine.wrap(f)
  local thread = create(f)
  local function finish(done, ...)
    if done then return ... end
    error((...), 0)
  end
  return function(...) return finish(resume(thread, ...)) end
end
)";

// Replaces field `name` of the table on top by `wrapper` with the original as upvalue.
void wrap(lua_State* state, const char* name, lua_CFunction wrapper) {
  lua_getfield(state, -1, name);
  lua_pushcclosure(state, wrapper, 1);
  lua_setfield(state, -2, name);
}

// A function of C without upvalues has no number, only an address: each field of the table on top
// becomes one with an upvalue, in the order of names.
void number_functions(lua_State* state) {
  std::vector<std::string> names;
  lua_pushnil(state);
  while (lua_next(state, -2)) {
    if (lua_type(state, -2) == LUA_TSTRING && lua_iscfunction(state, -1))
      names.emplace_back(lua_tostring(state, -2));
    lua_pop(state, 1);
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    lua_getfield(state, -1, name.c_str());
    if (lua_getupvalue(state, -1, 1)) {
      lua_pop(state, 2);
      continue;
    }
    const lua_CFunction function = lua_tocfunction(state, -1);
    lua_pop(state, 1);
    lua_pushnil(state);
    lua_pushcclosure(state, function, 1);
    lua_setfield(state, -2, name.c_str());
  }
}

void remove_fields(lua_State* state, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    lua_pushnil(state);
    lua_setfield(state, -2, name);
  }
}

void open_base(lua_State* state) {
  luaL_requiref(state, LUA_GNAME, luaopen_base, 1);
  remove_fields(state, {"collectgarbage", "dofile", "load", "loadfile", "warn"});
  wrap(state, "setmetatable", &guarded<set_metatable>);
  const luaL_Reg functions[] = {
      {"print", &guarded<print_described>}, {"require", &guarded<require>},
      {"pairs", &guarded<ordered_pairs>},   {"next", &guarded<ordered_next>},
      {"tostring", &guarded<described>},    {nullptr, nullptr}};
  luaL_setfuncs(state, functions, 0);
  lua_pop(state, 1);
}

void open_strings(lua_State* state) {
  luaL_requiref(state, LUA_STRLIBNAME, luaopen_string, 1);
  remove_fields(state, {"dump"});
  wrap(state, "find", &guarded<find>);
  wrap(state, "match", &guarded<match>);
  wrap(state, "gsub", &guarded<gsub>);
  wrap(state, "gmatch", &guarded<gmatch>);
  wrap(state, "rep", &guarded<rep>);
  wrap(state, "format", &guarded<format_described>);
  lua_pop(state, 1);
  lua_pushliteral(state, "");
  lua_getmetatable(state, -1);
  lua_pushliteral(state, "protected");
  lua_setfield(state, -2, "__metatable");
  lua_pop(state, 2);
}

void open_tables(lua_State* state) {
  luaL_requiref(state, LUA_TABLIBNAME, luaopen_table, 1);
  wrap(state, "insert", &guarded<insert>);
  wrap(state, "remove", &guarded<remove>);
  lua_pushcfunction(state, &guarded<stable_sort>);
  lua_setfield(state, -2, "sort");
  wrap(state, "concat", &guarded<concat>);
  wrap(state, "unpack", &guarded<unpack>);
  wrap(state, "move", &guarded<move>);
  lua_pop(state, 1);
}

}  // namespace

void open_allowed_libraries(lua_State* state) {
  open_base(state);
  open_strings(state);
  open_tables(state);
  luaL_requiref(state, LUA_MATHLIBNAME, luaopen_math, 1);
  const luaL_Reg numbers[] = {
      {"random", &guarded<random>}, {"randomseed", &guarded<refuse_seed>}, {nullptr, nullptr}};
  luaL_setfuncs(state, numbers, 0);
  luaL_requiref(state, LUA_UTF8LIBNAME, luaopen_utf8, 1);
  luaL_requiref(state, LUA_COLIBNAME, luaopen_coroutine, 1);
  remove_fields(state, {"close"});
  for (const char* table : {LUA_GNAME, LUA_STRLIBNAME, LUA_TABLIBNAME, LUA_MATHLIBNAME,
                            LUA_UTF8LIBNAME, LUA_COLIBNAME}) {
    lua_getglobal(state, table);
    number_functions(state);
    lua_pop(state, 1);
  }
  const std::string_view prelude = kPrelude;
  if (luaL_loadbufferx(state, prelude.data(), prelude.size(), "=sandbox", "t") != LUA_OK) {
    throw Error(lua_tostring(state, -1));
  }
  lua_call(state, 0, 0);
  lua_settop(state, 0);
}

double worst_pattern_steps(const char* pattern, std::size_t pattern_length, std::size_t length,
                           bool caret_anchors) {
  const char* at = pattern;
  const char* end = pattern + pattern_length;
  const bool anchored = caret_anchors && at < end && *at == '^';
  if (anchored) ++at;
  int loops = anchored ? 0 : 1;  // places where the matcher chooses among up to `length`
  double factor = 1;
  while (at < end) {
    if (*at == '%' && at + 1 < end) {
      const char kind = at[1];
      at += kind == 'b' ? std::min<std::ptrdiff_t>(4, end - at) : 2;
      if (kind == 'b' || (kind >= '0' && kind <= '9')) ++loops;
      if (kind == 'f') continue;  // the set follows
    } else if (*at == '[') {
      const char* begin = at++;
      if (at < end && *at == '^') ++at;
      do {
        at += at < end && *at == '%' ? 2 : 1;
      } while (at < end && *at != ']');
      at = std::min(at + 1, end);
      factor = std::max(factor, static_cast<double>(at - begin) / 4);
    } else {
      ++at;
    }
    if (at < end && (*at == '*' || *at == '+' || *at == '-'))
      ++loops, ++at;
    else if (at < end && *at == '?')
      factor *= 2, ++at;
  }
  // Ways to cut `length` characters at `loops` places: (length + loops) over loops.
  for (int k = 1; k <= loops; ++k) factor *= (static_cast<double>(length) + k) / k;
  return factor;
}

}  // namespace lapwing
