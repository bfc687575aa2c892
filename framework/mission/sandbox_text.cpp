// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/sandbox_text.h"

#include <algorithm>
#include <cstdio>

#include "framework/mission/guard.h"

namespace lapwing {

namespace {

constexpr std::size_t kLongestMessage = 4u << 10;  // bytes
constexpr std::size_t kLongestLine = 1u << 20;     // bytes, a line; Sandbox counts them all

bool is_object(int type) {
  return type == LUA_TTABLE || type == LUA_TFUNCTION || type == LUA_TUSERDATA ||
         type == LUA_TTHREAD || type == LUA_TLIGHTUSERDATA;
}

// "0x00000017", or "builtin" of a function that has no number.
std::string number_text(lua_State* state, int index) {
  const std::uint64_t number = Sandbox::of(state).heap().number_of(state, index);
  if (number == 0) return "builtin";
  char text[32];
  std::snprintf(text, sizeof text, "0x%08llx", static_cast<unsigned long long>(number));
  return text;
}

// Where a conversion ends: at its letter. `at` stands behind the '%'.
std::size_t end_of_conversion(std::string_view format, std::size_t at) {
  return std::min(format.find_first_not_of("-+ #0123456789.", at), format.size());
}

}  // namespace

void push_described(lua_State* state, int index) {
  index = lua_absindex(state, index);
  const int type = lua_type(state, index);
  if (!is_object(type)) {
    luaL_tolstring(state, index, nullptr);
    return;
  }
  if (luaL_getmetafield(state, index, "__tostring") != LUA_TNIL) {
    lua_pop(state, 1);
    luaL_tolstring(state, index, nullptr);
    return;
  }
  std::string text = lua_typename(state, type);
  if (luaL_getmetafield(state, index, "__name") != LUA_TNIL) {
    if (lua_type(state, -1) == LUA_TSTRING) text = text_argument(state, -1, "__name");
    lua_pop(state, 1);
  }
  push_text(state, text + ": " + number_text(state, index));
}

int described(lua_State* state) {
  luaL_checkany(state, 1);
  push_described(state, 1);
  return 1;
}

int print_described(lua_State* state) {
  std::string line;
  const int count = lua_gettop(state);
  for (int i = 1; i <= count && line.size() <= kLongestLine; ++i) {
    push_described(state, i);
    std::size_t length = 0;
    const char* text = lua_tolstring(state, -1, &length);
    if (i > 1) line += '\t';
    line.append(text, std::min(length, kLongestLine));  // more than that is refused as a whole
    lua_pop(state, 1);
  }
  Sandbox::of(state).print(line);
  return 0;
}

int format_described(lua_State* state) {
  std::size_t length = 0;
  const char* const given = luaL_checklstring(state, 1, &length);
  const std::string_view format(given, length);
  std::string changed;  // `format` with %s for %p; empty until there is one
  int argument = 1;
  for (std::size_t at = format.find('%'); at != format.npos && at + 1 < format.size();
       at = format.find('%', at)) {
    at = end_of_conversion(format, at + 1);
    if (at == format.size()) break;
    const char letter = format[at++];
    if (letter == '%') continue;
    ++argument;
    if ((letter != 's' && letter != 'p') || argument > lua_gettop(state)) continue;
    const bool object = is_object(lua_type(state, argument));
    if (letter == 's' && !object) continue;
    if (letter == 's') {
      push_described(state, argument);
    } else {
      if (changed.empty()) changed = format;
      changed[at - 1] = 's';
      push_text(state, object ? number_text(state, argument) : "(null)");
    }
    lua_replace(state, argument);
  }
  if (!changed.empty()) {
    push_text(state, changed);
    lua_replace(state, 1);
  }
  // In this function's own frame, so that messages name it as the script does.
  return lua_tocfunction(state, lua_upvalueindex(1))(state);
}

std::string as_message(std::string_view text) {
  const std::string_view shown = text.substr(0, kLongestMessage);
  std::string result;
  for (const char letter : shown) {
    if (letter == '\0')
      result += "\\0";
    else
      result += letter;
  }
  if (shown.size() < text.size())
    result += "... (" + std::to_string(text.size() - shown.size()) + " bytes more)";
  return result;
}

}  // namespace lapwing
