// SPDX-License-Identifier: Apache-2.0
// What a script or a file makes the program hold stays within the limit of memory, copies outside
// of Lua included: the peak of the whole process is measured.
#include <sys/resource.h>

#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class MemoryLimits : public CommandLine {
 protected:
  static constexpr double kLimit = 256;  // MB, sandbox.memory as it is

  // Bad input, and the most memory that the process had, MB.
  double refused_at(const std::vector<std::string>& arguments, const std::string& fragment) {
    const pid_t child = start(arguments);
    int status = 0;
    rusage usage{};
    ::wait4(child, &status, 0, &usage);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 2) << status;
    const std::string message = read_file(folder_ / "stderr.txt");
    EXPECT_NE(message.find(fragment), std::string::npos) << message.substr(0, 2000);
    EXPECT_LT(message.size(), 20'000u);
    return static_cast<double>(usage.ru_maxrss) / 1024;
  }

  void within_limit(const std::string& script, const std::string& fragment) {
    write("shot.lua", script);
    EXPECT_LT(refused_at({"run", "shot.lua"}, fragment), kLimit) << script;
  }

  static std::string repeated(const std::string& piece, std::size_t bytes) {
    std::string text;
    while (text.size() + piece.size() <= bytes) text += piece;
    return text;
  }
};

TEST_F(MemoryLimits, HoldForLongTexts) {
  const std::string mission = ", options = {}, plan = function() end }";
  within_limit("return { kind = 'k', name = ('x'):rep(1e8)" + mission, "raise sandbox.memory");
  within_limit("error(('x'):rep(1e8))", "x... (");
  within_limit("print(('x'):rep(1e8))", "more than a megabyte");
  within_limit("lapwing.fail(('x'):rep(1e8))", "a text of 100000000 bytes");
  within_limit("require(('x'):rep(1e8))", "a text of 100000000 bytes");
  within_limit(
      "return { kind = 'k', name = 'n', options = { [('x'):rep(5e7)] = 1 }, "
      "plan = function() end }",
      "options: a name of more than 1000 bytes");
}

TEST_F(MemoryLimits, HoldForManyValues) {
  within_limit(
      "local l = {} for i = 1, 2e6 do l[i] = i end\n"
      "return { kind = 'k', name = 'n', options = { l = l }, plan = function() end }",
      "sandbox.memory");
}

TEST_F(MemoryLimits, HoldForFilesThatAScriptReads) {
  write("wide.json", "[" + repeated("1,", 16u << 20) + "1]");
  within_limit("return lapwing.read_json('wide.json')", "shot.lua:1: the script needs more than");
  write("long.txt", repeated("x", 60u << 20));
  within_limit("local t = {} for i = 1, 9 do t[i] = lapwing.read_text('long.txt') .. i end",
               "sandbox.memory");
}

TEST_F(MemoryLimits, HoldForConfigurations) {
  write("shot.lua", film(""));
  for (const char* piece : {"[", "{", "{a: ", "[a, ", "a,", "[],"}) {
    write("big.yaml", (*piece == 'a' ? "[" : "") + repeated(piece, 4u << 20));
    EXPECT_LT(refused_at({"run", "shot.lua", "--config", "big.yaml"}, "big.yaml"), kLimit) << piece;
  }
}

TEST_F(MemoryLimits, TextsWithNulAreWhole) {
  write("shot.lua", "error('a\\0b')");
  refused({"run", "shot.lua"}, {"shot.lua:1: a\\0b"});
  write("shot.lua", "lapwing.fail('a\\0b')");
  refused({"run", "shot.lua"}, {"shot.lua:1: a\\0b"});
  write("shot.lua", "return { kind = 'k', name = 'a\\0b', options = {}, plan = function() end }");
  refused({"run", "shot.lua"}, {"mission.name: a text with a NUL character is not allowed here"});
}

}  // namespace
}  // namespace lapwing
