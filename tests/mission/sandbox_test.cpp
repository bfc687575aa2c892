// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/sandbox.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <lua.hpp>

#include "framework/core/files.h"
#include "framework/core/progress.h"
#include "framework/mission/sandbox_library.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class SandboxTest : public ::testing::Test {
 protected:
  SandboxTest() {
    folder_ = fs::temp_directory_path() / ("lapwing_sandbox_" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "user");
    fs::create_directories(folder_ / "scripts/mission");
    limits_.memory = 32;
    limits_.instructions = 1'000'000;
    limits_.seconds = 30;
  }
  ~SandboxTest() override { fs::remove_all(folder_); }

  // Runs a script; returns its result as text, or "error: " and the message.
  std::string run(const std::string& text) {
    script_ = (folder_ / "user/shot.lua").string();
    write_file_atomically(script_, text);
    Sandbox sandbox(limits_, 7, {folder_ / "scripts"},
                    [this](const std::string& line) { printed_ += line + "\n"; });
    sandbox.watch(&cancellation_);
    std::string result;
    try {
      sandbox.protect([&](lua_State* state) {
        sandbox.run_script(state, script_);
        result = luaL_tolstring(state, -1, nullptr);
      });
    } catch (const InputError& error) {
      result = std::string("error: ") + error.what();
    }
    // Messages without the folder, so that tests can state them.
    for (std::size_t at; (at = result.find(folder_.string() + "/user/")) != std::string::npos;) {
      result.erase(at, folder_.string().size() + 6);
    }
    return result;
  }

  void expect(const std::string& text, const std::string& fragment) {
    const std::string result = run(text);
    EXPECT_NE(result.find(fragment), std::string::npos) << text << "\ngave: " << result;
  }

  fs::path folder_;
  SandboxLimits limits_;
  CancellationToken cancellation_;
  std::string script_, printed_;
};

TEST_F(SandboxTest, RunsPlainLua) {
  EXPECT_EQ(run("local t = {} for i = 1, 10 do t[i] = i * i end return table.concat(t, ' ')"),
            "1 4 9 16 25 36 49 64 81 100");
  EXPECT_EQ(run("return ('  trim me  '):match('^%s*(.-)%s*$') .. string.rep('ab', 3, '-')"),
            "trim meab-ab-ab");
  EXPECT_EQ(run("return select(2, ('a,b,c'):gsub(',', ';'))"), "2");
  EXPECT_EQ(run("local n = 0 for w in ('one two three'):gmatch('%a+') do n = n + 1 end return n"),
            "3");
  EXPECT_EQ(run("print('a', 1, nil) return 1"), "1");
  EXPECT_EQ(printed_, "a\t1\tnil\n");
}

TEST_F(SandboxTest, PrintingHasAnEnd) {
  expect("while true do print(('x'):rep(1000)) end", "shot.lua:1: print: more than a megabyte");
  EXPECT_LT(printed_.size(), (1u << 20) + 2000);
}

TEST_F(SandboxTest, ReplacedFunctionsBehaveAsLuasOwn) {
  EXPECT_EQ(run("return select('#', xpcall(function(...) return ... end, print, 1, nil, nil))"),
            "4");
  EXPECT_EQ(run("return select(2, xpcall(error, function(m) return m .. '!' end, 'oh'))"), "oh!");
  EXPECT_EQ(
      run("local g = coroutine.wrap(function(a) local b = coroutine.yield(a + 1) return b * 2 "
          "end) return g(1) + g(10)"),
      "22");
  EXPECT_EQ(run("return select(2, pcall(coroutine.wrap(function() error('deep', 0) end)))"),
            "deep");
  EXPECT_EQ(run("local t = {5, 3, 4} table.sort(t, function(a, b) return a > b end) "
                "table.insert(t, 1, 9) table.remove(t) return table.concat(t, ',', 1, 3)"),
            "9,5,4");
  EXPECT_EQ(run("return table.unpack(table.move({1, 2, 3}, 2, 3, 1))"), "2");
}

TEST_F(SandboxTest, PairsVisitsInOrderWhateverTheHash) {
  EXPECT_EQ(run("local s = '' local t = {zeta=1, alpha=2, [3]=0, [1]=0, mid=3}\n"
                "for k in pairs(t) do s = s .. k .. ' ' t.mid = nil end return s"),
            "1 3 alpha zeta ");
  EXPECT_EQ(run("local t = setmetatable({}, {__pairs = function() return next, {x=1}, nil end})\n"
                "for k in pairs(t) do return k end"),
            "x");
}

TEST_F(SandboxTest, RandomNumbersRepeat) {
  const std::string script =
      "return math.random() .. ' ' .. math.random(6) .. ' ' .. "
      "math.random(-3, 3)";
  EXPECT_EQ(run(script), run(script));
  expect("math.randomseed(3)", "--seed");
  expect("return math.random(3, 2)", "interval is empty");
}

TEST_F(SandboxTest, ErrorsNameFileAndLine) {
  EXPECT_EQ(run("local a = 1\nlocal b = nil + a"),
            "error: shot.lua:2: attempt to perform arithmetic on a nil value");
  EXPECT_EQ(run("\n\nerror('no such film')"), "error: shot.lua:3: no such film");
  EXPECT_EQ(run("\nassert(false, 'wanted more')"), "error: shot.lua:2: wanted more");
  expect("return {\n1, 2\n", "shot.lua:3: '}' expected");
  expect("\n\nerror({code = 3})",
         "shot.lua:3: the script raised an error that is not a text but a table");
  expect("\nerror(setmetatable({}, {__tostring = function() while true do end end}))",
         "shot.lua:2: the script raised an error that is not a text");
  expect("error()", "shot.lua:1: the script raised an error that is not a text but a nil");
}

TEST_F(SandboxTest, LongFileNamesStayWhole) {
  const fs::path deep = folder_ / "user" / std::string(90, 'd');
  fs::create_directories(deep);
  script_ = (deep / "shot.lua").string();
  write_file_atomically(script_, "\nlocal x = nil + 1");
  Sandbox sandbox(limits_, 1, {}, [](const std::string&) {});
  try {
    sandbox.protect([&](lua_State* state) { sandbox.run_script(state, script_); });
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(script_ + ":2: ", 0), 0u) << error.what();
  }
}

TEST_F(SandboxTest, EndlessLoopsEnd) {
  for (const char* script :
       {"while true do end", "while true do pcall(function() while true do end end) end",
        "local f = function() while true do end end while true do pcall(pcall, f) end",
        "while true do xpcall(function() while true do end end, function() while true do end end) "
        "end",
        "local co = coroutine.wrap(function() while true do end end) co()",
        "while true do local co = coroutine.create(function() while true do end end) "
        "coroutine.resume(co) end",
        "while true do pcall(coroutine.wrap(function() pcall(function() while true do end end) "
        "while true do end end)) end",
        "coroutine.wrap(function() local x <close> = setmetatable({}, {__close = function() "
        "while true do end end}) while true do end end)()",
        "pcall(function() local x <close> = setmetatable({}, {__close = function() "
        "while true do end end}) while true do end end)",
        "goto a ::a:: goto a", "repeat until false", "local function f() return f() end return f()",
        "setmetatable(_G, {__index = function(t, k) return t[k .. 'x'] end}) while true do pcall("
        "function() return foo end) end",
        "local t = setmetatable({}, {__eq = function() while true do end end}) "
        "while true do pcall(function() return t == setmetatable({}, getmetatable(t)) end) end"}) {
    const auto start = std::chrono::steady_clock::now();
    expect(script, "raise sandbox.instructions");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20)) << script;
    expect(script, "shot.lua:1: ");
  }
}

TEST_F(SandboxTest, TheClockEndsWhatInstructionsDoNot) {
  limits_.instructions = 1'000'000'000'000;
  limits_.seconds = 0.3;
  for (const char* script :
       {"while true do end", "while true do pcall(function() while true do end end) end",
        "local s = ('x'):rep(3000000) while true do local t = s:upper() end",
        "local s = ('a'):rep(5000) while true do pcall(string.find, s, '.-b') end",
        "local t = {} for i = 1, 300000 do t[i] = i end while true do pcall(table.sort, t) end",
        "local t = {} for i = 1, 300000 do t[i] = i end while true do for k in pairs(t) do break "
        "end end",
        "local t = {} for i = 1, 300000 do t[i] = '' end while true do table.concat(t) end"}) {
    const auto start = std::chrono::steady_clock::now();
    expect(script, "raise sandbox.seconds");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20)) << script;
  }
}

TEST_F(SandboxTest, WorkInsideCFunctionsIsRefusedBeforehand) {
  expect("return string.find(('a'):rep(30000), ('.-'):rep(8) .. 'b')", "sandbox.pattern_work");
  expect("return (('a'):rep(30000)):match(('a*'):rep(8) .. 'b')", "sandbox.pattern_work");
  expect("return (('a'):rep(30000)):gsub(('a?'):rep(60) .. ('%a+'):rep(5) .. 'b', '')",
         "sandbox.pattern_work");
  expect("for w in (('a'):rep(30000)):gmatch('^(.-)(.-)(.-)(.-)b') do end", "sandbox.pattern_work");
  expect("return string.rep('', 1 << 60)", "string.rep");
  expect("return table.move({}, 1, 1 << 60, 2)", "table.move");
  expect("return string.rep('', 1e18)", "string.rep");  // a float that is a count
  expect("return table.move({1, 2}, 1, 2^31, 2)", "table.move");
  expect("return table.move({1, 2}, 1, '1000000000000', 2)", "table.move");
  expect("return table.move({}, -(1 << 62), 1 << 62, 2)", "table.move");
  expect("return table.concat(setmetatable({}, {__index = rawlen}), '', 1, 1 << 50)",
         "table.concat");
  expect("table.insert(setmetatable({}, {__len = function() return 1 << 60 end}), 1, 0)", "__len");
  expect("table.remove(setmetatable({}, {__len = function() return 1 << 60 end}), 1)", "__len");
  expect("return table.unpack({}, 1, 1 << 40)", "table.unpack");
  expect("return string.rep('', 2.0 ^ 60)", "string.rep");
  expect("return string.rep('', '9999999999999')", "string.rep");
  expect("return table.move({}, '1', 2.0 ^ 50, 2)", "table.move");
}

TEST(PatternSteps, GrowWithTheRepetitions) {
  const auto steps = [](const std::string& pattern, std::size_t length) {
    return worst_pattern_steps(pattern.data(), pattern.size(), length, true);
  };
  EXPECT_EQ(steps("abc", 99), 100);
  EXPECT_EQ(steps("^abc", 99), 1);
  EXPECT_EQ(steps("^a*", 99), 100);
  EXPECT_EQ(steps("^%*%-%+", 99), 1);
  EXPECT_LT(steps("^%s*(.-)%s*$", 1000), 2e8);            // trimming a long line
  EXPECT_LT(steps("([^,]+),([^,]+),([^,]+)", 100), 2e8);  // a table's row
  EXPECT_GT(steps("a*a*a*a*b", 30000), 1e15);
  EXPECT_EQ(steps("%", 9), 10);
  EXPECT_EQ(steps("[", 9), 10);
  EXPECT_EQ(steps("%b", 9), steps("%b()", 9));
  EXPECT_GT(steps("[%]a-z]*", 9), steps("%a", 9));
}

TEST_F(SandboxTest, MemoryIsCapped) {
  limits_.instructions = 50'000;
  for (const char* script :
       {"local t = {} while true do t[#t + 1] = {('x'):rep(1000)} end",
        "local s = 'x' while true do s = s .. s end", "return ('x'):rep(1 << 40)",
        "return ('x'):rep(1 << 30, ('y'):rep(1000))",
        "local t = {} while true do pcall(function() t[#t + 1] = ('x'):rep(1000000) .. #t end) "
        "end"}) {
    const std::string result = run(script);
    EXPECT_TRUE(result.find("raise sandbox.") != std::string::npos ||
                result.find("resulting string too large") != std::string::npos)
        << script << "\n"
        << result;
    EXPECT_NE(result.find("shot.lua:1: "), std::string::npos) << result;
  }
}

TEST_F(SandboxTest, DeepRecursionIsAnError) {
  limits_.memory = 128;
  limits_.instructions = 100'000'000;
  expect("local function f(n) return 1 + f(n + 1) end return f(1)", "stack overflow");
  expect(
      "local t = setmetatable({}, {}) getmetatable(t).__index = function(s, k) return s[k] end "
      "return t.x",
      "stack overflow");
  expect("return " + std::string(500, '(') + "1" + std::string(500, ')'), "shot.lua:1: ");
  expect("local function f() return coroutine.wrap(f)() end return f()", "stack overflow");
  EXPECT_EQ(run("return tostring(pcall(string.gsub, 'x', ('('):rep(100) .. (')'):rep(100), ''))"),
            "false");
}

TEST_F(SandboxTest, NothingForbiddenIsReachable) {
  for (const char* name : {"os", "io", "debug", "package", "load", "loadstring", "loadfile",
                           "dofile", "collectgarbage", "warn", "string.dump", "_G.os", "_G.debug",
                           "_ENV.io", "coroutine.close", "getmetatable(_G)", "lfs", "ffi", "jit"}) {
    EXPECT_EQ(run(std::string("return ") + name), "nil") << name;
  }
  EXPECT_EQ(run("return getmetatable('').__index"), "nil");
  EXPECT_EQ(run("return getmetatable('')"), "protected");
  expect("getmetatable('').__index = function() end", "attempt to");
  expect("setmetatable({}, {__gc = function() while true do end end})", "__gc");
  EXPECT_EQ(run("local mt = {} local t = setmetatable({}, mt) mt.__gc = function() while true do "
                "end end t = nil return 1"),
            "1");
  EXPECT_EQ(run("setmetatable(_G, {__index = function(_, k) return k end}) return os"), "os");
}

TEST_F(SandboxTest, BytecodeIsRefused) {
  expect("\x1bLua\x54\x00\x19\x93", "shot.lua:1: this is precompiled Lua");
  expect("#!/usr/bin/lua\n\x1bLua", "shot.lua:1: ");
}

TEST_F(SandboxTest, RequireReadsOnlyModuleFolders) {
  write_file_atomically(folder_ / "scripts/mission/good.lua", "return { answer = 42 }");
  write_file_atomically(folder_ / "user/near.lua", "return 'near'");
  write_file_atomically(folder_ / "user/circle.lua", "return require 'circle'");
  write_file_atomically(folder_ / "user/bad.lua", "\nlocal x = nil + 1");
  write_file_atomically(folder_ / "outside.lua", "return 'out'");
  fs::create_symlink(folder_ / "outside.lua", folder_ / "user/link.lua");
  fs::create_directory_symlink(folder_, folder_ / "user/up");
  EXPECT_EQ(run("return require('mission.good').answer"), "42");
  EXPECT_EQ(run("return tostring(require('mission.good') == require 'mission.good')"), "true");
  EXPECT_EQ(run("return require 'near'"), "near");
  for (const char* name : {"../outside", "..outside", ".near", "near.", "/etc/passwd", "up/outside",
                           "", "a b", "mission/good"}) {
    expect(std::string("return require '") + name + "'", "is not a module name");
  }
  expect("return require 'link'", "leads out of");
  expect("return require 'up.outside'", "leads out of");
  expect("\nreturn require('missing')", "shot.lua:2: module 'missing' not found; looked for ");
  expect("return require('circle')", "requires itself");
  expect("pcall(require, 'circle') return require('circle')", "requires itself");
  expect("\nlocal x = require('bad')", "bad.lua:2: attempt to perform arithmetic");
  expect("\nlocal x = require('bad')", "(called from shot.lua:2)");
  expect("return require(3)", "expected a text");
}

TEST_F(SandboxTest, AnInterruptionEndsTheScript) {
  CancellationToken token;
  Sandbox sandbox({}, 1, {}, [](const std::string&) {});
  sandbox.watch(&token);
  write_file_atomically(folder_ / "user/loop.lua", "for i = 1, 100000 do end");
  token.cancel();  // what is short may still finish
  sandbox.protect([&](lua_State* state) { sandbox.run_script(state, folder_ / "user/loop.lua"); });
  write_file_atomically(folder_ / "user/loop.lua", "while true do pcall(error) end");
  EXPECT_THROW(sandbox.protect(
                   [&](lua_State* state) { sandbox.run_script(state, folder_ / "user/loop.lua"); }),
               Cancelled);
}

TEST_F(SandboxTest, DefectsOfBindingsKeepTheirType) {
  Sandbox sandbox(limits_, 1, {}, [](const std::string&) {});
  EXPECT_THROW(sandbox.protect([](lua_State*) { throw std::logic_error("broken"); }),
               std::logic_error);
  EXPECT_THROW(sandbox.protect([](lua_State*) { throw InputError("wrong"); }), InputError);
  sandbox.protect([](lua_State*) {});
}

// An interruption leaves a script time to finish with what it has, and ends one that does not.
TEST_F(SandboxTest, AnInterruptionEndsALoopAfterAGrace) {
  cancellation_.cancel();
  limits_.instructions = 1'000'000'000;
  EXPECT_EQ(run("local s = 0 for i = 1, 100000 do s = s + 1 end return s"), "100000");
  EXPECT_THROW(run("while true do pcall(function() while true do end end) end"), Cancelled);
}

}  // namespace
}  // namespace lapwing
