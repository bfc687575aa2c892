// SPDX-License-Identifier: Apache-2.0
// pairs, next, tostring, string.format and table.sort behave as Lua's own wherever Lua says what
// they do.
#include <gtest/gtest.h>
#include <unistd.h>

#include <lua.hpp>

#include "framework/core/files.h"
#include "framework/mission/sandbox.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class SandboxOrder : public ::testing::Test {
 protected:
  SandboxOrder() {
    script_ = fs::temp_directory_path() / ("lapwing_order_" + std::to_string(::getpid()) + ".lua");
  }
  ~SandboxOrder() override { fs::remove(script_); }

  // What the script returns, as text; or its error.
  std::string run(const std::string& text) {
    write_file_atomically(script_, text);
    Sandbox sandbox(limits_, 7, {}, [](const std::string&) {});
    std::string result;
    try {
      sandbox.protect([&](lua_State* state) {
        sandbox.run_script(state, script_);
        result = luaL_tolstring(state, -1, nullptr);
      });
    } catch (const InputError& error) {
      result = error.what();
    }
    return result;
  }

  fs::path script_;
  SandboxLimits limits_;
};

TEST_F(SandboxOrder, KeysComeByKindAndValue) {
  EXPECT_EQ(run("local t = {[true]=1, [false]=2, b=3, a=4, ['a\\0z']=5, ['a\\0b']=6, [3]=7, "
                "[-1]=8, [2.5]=9, [1e300]=10, [-1/0]=11, [(1<<53)+1]=12, [1<<53]=13, [2^60]=14}\n"
                "local s = '' for _, v in pairs(t) do s = s .. v .. ' ' end\n"
                "for _, v in next, t do s = s .. v .. ' ' end return s"),
            "11 8 9 7 13 12 14 10 4 6 5 3 2 1 11 8 9 7 13 12 14 10 4 6 5 3 2 1 ");
  EXPECT_EQ(run("local a, b, c = {}, {}, {} local t = {[c]='c', [a]='a', [b]='b', [print]='p'}\n"
                "local s = '' for _, v in next, t do s = s .. v end return s"),
            "abcp");
}

TEST_F(SandboxOrder, NextBehavesAsLuas) {
  EXPECT_EQ(run("return tostring(next({})) .. tostring(next({}, nil)) .. next({5})"), "nilnil1");
  EXPECT_EQ(run("local t = {1, 2, 3} return tostring(next(t, 3)) .. next(t, 1.0)"), "nil2");
  // Removing while one walks, and a walk within a walk.
  EXPECT_EQ(
      run("local t, s = {a=1, b=2, c=3, d=4}, ''\n"
          "for k in next, t do t[k] = nil for j in next, t do s = s .. j end s = s .. ';' end\n"
          "return s .. tostring(next(t))"),
      "bcd;cd;d;;nil");
  // A key that came after the order was made is found by the next walk.
  EXPECT_EQ(run("local t, s = {a=1, c=3}, ''\nfor k in next, t do s = s .. k break end\n"
                "next(t, 'a') t.b = 2 for k in next, t do s = s .. k end return s"),
            "aabc");
  EXPECT_EQ(run("local t = {} for i = 1, 200 do t['k' .. i] = i end\n"
                "local n = 0 while next(t) do t[next(t)] = nil n = n + 1 end return n"),
            "200");
  EXPECT_NE(run("next({}, 0/0)").find("invalid key to 'next'"), std::string::npos);
  EXPECT_NE(run("next(3)").find("table expected"), std::string::npos);
}

TEST_F(SandboxOrder, WalksTakeTimeInProportion) {
  limits_.instructions = 1'000'000'000;
  limits_.seconds = 20;
  EXPECT_EQ(run("local t = {} for i = 1, 200000 do t['k' .. i] = i end\n"
                "local n = 0 for k, v in next, t do n = n + v end return n"),
            "20000100000");
}

TEST_F(SandboxOrder, WhatHasNoOrderIsRefused) {
  EXPECT_EQ(run("local t = {[(ipairs{})]=1} for _, v in pairs(t) do return v end"), "1");
}

TEST_F(SandboxOrder, TextsShowNumbersForObjects) {
  EXPECT_EQ(run("local a, b = {}, {} return tostring(tostring(a) == tostring(a) and "
                "tostring(a) ~= tostring(b) and tostring(a):match('^table: 0x%x+$') ~= nil)"),
            "true");
  EXPECT_EQ(run("return tostring((ipairs{}))"), "function: builtin");
  EXPECT_EQ(run("return string.format('%p|%5.1f|%%|%q|%-6s|', 3, 2.25, 'x', 'ab')"),
            "(null)|  2.2|%|\"x\"|ab    |");
  EXPECT_EQ(run("return ('%s %s'):format(setmetatable({}, {__tostring = function() return 'me' "
                "end}), nil)"),
            "me nil");
  EXPECT_NE(run("return ('%d'):format({})").find("bad argument #1 to 'format'"), std::string::npos);
  EXPECT_NE(run("return ('%s')  :format()").find("bad argument"), std::string::npos);
  EXPECT_EQ(run("return tostring(setmetatable({}, {__name = 'own'})):match('^own: ')"), "own: ");
}

TEST_F(SandboxOrder, SortingIsStableAndSafe) {
  EXPECT_EQ(run("local t = {} for i = 1, 1000 do t[i] = {i * 7919 % 10, i} end\n"
                "table.sort(t, function(a, b) return a[1] < b[1] end)\n"
                "for i = 2, 1000 do local a, b = t[i-1], t[i]\n"
                "if a[1] > b[1] or a[1] == b[1] and a[2] > b[2] then return i end end return 'ok'"),
            "ok");
  for (int n : {0, 1, 2, 3, 5, 17, 1023, 1024, 1025})
    EXPECT_EQ(run("local t = {} for i = 1, " + std::to_string(n) +
                  " do t[i] = (i * 7919) % 1009 end table.sort(t)\n"
                  "for i = 2, #t do if t[i - 1] > t[i] then return i end end return 'ok'"),
              "ok");
  EXPECT_EQ(run("local t = {} for i = 1, 3000 do t[i] = i end\n"
                "table.sort(t, function() return true end) return #t"),
            "3000");
  EXPECT_NE(run("table.sort({1, 'a'})").find("attempt to compare"), std::string::npos);
  EXPECT_NE(run("table.sort({1, 2}, 3)").find("function expected"), std::string::npos);
}

// Garbage is still collected, and what is kept is not.
TEST_F(SandboxOrder, GarbageIsCollected) {
  limits_.memory = 40;
  EXPECT_EQ(run("local keep = {} for i = 1, 100000 do local t = {i, {}} if i % 1000 == 0 then "
                "keep[#keep + 1] = t end end return keep[100][1]"),
            "100000");
  EXPECT_EQ(run("local s for i = 1, 2000 do s = ('x'):rep(100000) .. i end return #s"), "100004");
  EXPECT_EQ(run("for i = 1, 300 do local t = {} for k = 1, 50000 do t[k] = k end end return 1"),
            "1");
}

}  // namespace
}  // namespace lapwing
