// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/lua_value.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/mission/sandbox.h"

namespace lapwing {
namespace {

// The value that a Lua expression becomes, as JSON, or "error: " and the message.
std::string read(const std::string& expression, std::span<const std::string_view> without = {}) {
  const std::filesystem::path script = std::filesystem::temp_directory_path() /
                                       ("lapwing_value_" + std::to_string(::getpid()) + ".lua");
  write_file_atomically(script, "return " + expression);
  Sandbox sandbox({}, 1, {}, [](const std::string&) {});
  std::string result;
  try {
    sandbox.protect([&](lua_State* state) {
      sandbox.run_script(state, script);
      result = to_json(value_from_lua(state, -1, {"shot.lua", 4}, "given", without), -1);
    });
  } catch (const InputError& error) {
    result = std::string("error: ") + error.what();
  }
  std::filesystem::remove(script);
  return result;
}

TEST(LuaValue, ReadsTables) {
  EXPECT_EQ(read("{1, 2.5, 'three', true}"), R"([1,2.5,"three",true])");
  EXPECT_EQ(read("{b = 1, a = {c = {}}, ['with space'] = 'x'}"),
            R"({"a":{"c":[]},"b":1,"with space":"x"})");
  EXPECT_EQ(read("{}"), "[]");
  EXPECT_EQ(read("nil"), "null");
  EXPECT_EQ(read("7 // 2"), "3");
  EXPECT_EQ(read("{a = 1, b = 2, c = 3}", std::vector<std::string_view>{"b"}), R"({"a":1,"c":3})");
  EXPECT_EQ(read("setmetatable({1}, {__index = function() return 5 end})"), "[1]");
}

TEST(LuaValue, RefusesWhatNoTreeHolds) {
  const auto expect = [](const std::string& expression, const std::string& fragment) {
    EXPECT_NE(read(expression).find(fragment), std::string::npos)
        << expression << "\ngave: " << read(expression);
  };
  expect("{x = {0 / 0}}", "shot.lua:4: given.x[1]: expected a finite number, got NaN");
  expect("{x = {y = 1 / 0}}", "given.x.y: expected a finite number, got an infinity");
  expect("{s = '\\xff'}", "given.s: expected text in UTF-8");
  expect("{f = print}", "given.f: a function is not allowed here");
  expect("{1, 2, x = 3}", "given: a table with both numbered and named entries ('x')");
  expect("{[1] = 1, [3] = 3}", "given: a list with gaps");
  expect("{[0] = 1}", "given: a list with gaps");
  expect("{[1.5] = 1}", "keys must be texts");
  expect("{[true] = 1}", "not a boolean");
  expect("(function() local t = {} t.a = {t} return t end)()",
         "given.a[1]: a table that contains itself");
  expect("(function() local t = {} for i = 1, 40 do t = {t} end return t end)()",
         "tables nested more than 32 deep");
  // Twice the same table is no circle.
  EXPECT_EQ(read("(function() local p = {1} return {p, p} end)()"), "[[1],[1]]");
}

TEST(LuaValue, GoesBackToLua) {
  Sandbox sandbox({}, 1, {}, [](const std::string&) {});
  const Value value = from_json(R"({"a": [1, 2.5, null, {"b": "text"}], "c": true})", "test");
  sandbox.protect([&](lua_State* state) {
    push_value(state, value);
    lua_getfield(state, -1, "a");
    EXPECT_EQ(lua_rawgeti(state, -1, 1), LUA_TNUMBER);
    EXPECT_TRUE(lua_isinteger(state, -1));
    lua_pop(state, 1);
    EXPECT_EQ(lua_rawgeti(state, -1, 3), LUA_TNIL);
    lua_pop(state, 1);
    lua_rawgeti(state, -1, 4);
    EXPECT_EQ(to_json(value_from_lua(state, -1, {}), -1), R"({"b":"text"})");
  });
}

}  // namespace
}  // namespace lapwing
