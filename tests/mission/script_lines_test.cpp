// SPDX-License-Identifier: Apache-2.0
// Errors of options name the line where the option is written in the script.
#include "framework/mission/script_lines.h"

#include "framework/config/yaml.h"
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

// Lines of a value's nodes, "key: line", the call being on line 100.
std::string lines_of(const Value& value, const std::string& path = "") {
  std::string text;
  const auto add = [&](const Value& child, const std::string& name) {
    text += name + ":" + std::to_string(child.origin().line) + " " + lines_of(child, name + ".");
  };
  if (value.is_map())
    for (const auto& [key, child] : value.as_map()) add(child, path + key);
  if (value.is_list())
    for (std::size_t i = 0; i < value.as_list().size(); ++i)
      add(value.as_list()[i], path + std::to_string(i + 1));
  return text;
}

Value all_on_line_100(Value value) {
  value.with_origin({"shot.lua", 100});
  if (value.is_map())
    for (auto& entry : value.as_map()) entry.second = all_on_line_100(entry.second);
  if (value.is_list())
    for (Value& entry : value.as_list()) entry = all_on_line_100(entry);
  return value;
}

std::string located(const std::string& script, int line, const std::string& yaml) {
  Value value = all_on_line_100(from_yaml(yaml, "shot.lua"));
  locate_argument(value, script, line);
  return lines_of(value);
}

TEST(ScriptLines, FieldsOfAConstructor) {
  EXPECT_EQ(
      located("return f {\n a = 1,\n b = { c = 'x',\n d = 2 } }", 1, "{a: 1, b: {c: x, d: 2}}"),
      "a:2 b:3 b.c:3 b.d:4 ");
  EXPECT_EQ(located("return f({ a = 1 })", 1, "{a: 1}"), "a:1 ");
  EXPECT_EQ(located("#!/usr/bin/lua\n\nf{['a'] = 1; -- b = 2\n --[[ c\n = 3 ]] b = [[x]]\n}", 3,
                    "{a: 1, b: x}"),
            "a:3 b:5 ");
  EXPECT_EQ(located("f { k = {\n {p = {1, 2}},\n {p = {3,\n -4}} } }", 1,
                    "{k: [{p: [1, 2]}, {p: [3, -4]}]}"),
            "k:1 k.1:2 k.1.p:2 k.1.p.1:2 k.1.p.2:2 k.2:3 k.2.p:3 k.2.p.1:3 k.2.p.2:4 ");
}

TEST(ScriptLines, ExpressionsDoNotEndAField) {
  const std::string script =
      "f { a = g(1, { b = 9 }),\n"
      " h = function(s) if s then return { b = 8 }, 2; end for i = 1, 2 do end end,\n"
      " t = \"},\" .. x[\"{\"],\n b = 1 }";
  EXPECT_EQ(located(script, 1, "{a: 5, t: y, b: 1}"), "a:1 t:3 b:4 ");
  EXPECT_EQ(located("f { a = { b = 1 }.b,\n c = {} or d }", 1, "{a: {b: 1}, c: {d: 1}}"),
            "a:1 a.b:100 c:2 c.d:100 ");
}

TEST(ScriptLines, WhatIsWrittenElsewhereKeepsTheCall) {
  EXPECT_EQ(located("local given = { a = 1 }\nreturn f(given)", 2, "{a: 1}"), "a:100 ");
  EXPECT_EQ(located("return f({ a = 1 }, { a = 2 })", 1, "{a: 2}"), "a:100 ");
  EXPECT_EQ(located("f { k = { 1, table.unpack(more) } }", 1, "{k: [1, 2, 3]}"),
            "k:1 k.1:100 k.2:100 k.3:100 ");
  EXPECT_EQ(located("f { [x] = 1 }", 1, "{a: 1}"), "a:100 ");
  // Whatever the text is, reading it ends.
  for (const char* text : {"f {", "f { a = ", "f { a = {{{", "f { [", "f { 'a", "f { --[[", "f{)}"})
    EXPECT_EQ(located(text, 1, "{b: 1}"), "b:100 ") << text;
}

TEST(ScriptLines, OptionsOfAMissionOfOnesOwn) {
  Value value = all_on_line_100(from_yaml("{a: 1, b: {c: 2}}", "x"));
  locate_in_result(value,
                   "local function g()\n return { options = { a = 1 } }\nend\n"
                   "return { kind = 'x',\n options = { a = 1,\n b = { c = 2 } },\n"
                   " plan = function(run)\n return {}\n end }",
                   "options");
  EXPECT_EQ(lines_of(value), "a:5 b:6 b.c:6 ");
}

class ScriptLinesOfErrors : public MissionTest {};

TEST_F(ScriptLinesOfErrors, NameTheFieldAndNotTheCall) {
  expect(film("  margin = 0.6,\n  hrad = 0.3,"), "shot.lua:9: hrad: unknown key");
  expect(film("  start = 'moving',\n  speed = -3,"), "shot.lua:9: speed: expected");
  // As run:fail reports, once the options were checked.
  expect(film("  battery = 5000,\n  vehicle = 'vehicles/none',"), "shot.lua:9: ");
  expect(
      "return require('mission.race').course {\n laps = 3,\n gates = {\n { shape = 'ball', "
      "position = {0, 0, 2}, radius = -1 } } }",
      "shot.lua:2: laps: laps need a closed course");
  expect(
      "return require('mission.race').course {\n start = {0, 0, 2},\n gates = {\n { shape = "
      "'ball', position = {0, 0, 2},\n radius = -1 } } }",
      "shot.lua:5: gates[1].radius: a ball cannot be entered");
  // A function that ran since, and the frame that a tail call leaves behind, are not in the way.
  expect(
      "return require('mission.film').shot {\n keyframes = { { time = 0, position = {0, 0, 2} "
      "} },\n subject = { track = function(t)\n return {t, 0, 0} end }, duration = 3,\n "
      "speed = 0 / 0 }",
      "shot.lua:1: speed: expected a finite number");
  // The option that names a file which is not there.
  const std::string race =
      "return require('mission.race').course {\n laps = 1,\n input = 'a.yaml' }";
  expect(race, "shot.lua:3: input: data file 'a.yaml' not found");
  expect(race, "--set input=b.yaml: input: data file 'b.yaml' not found", {"input=b.yaml"});
  expect(film("  obstacles = {\n { type = 'mesh', file = 'c.obj' } },"),
         "shot.lua:9: obstacles[1].file: data file 'c.obj' not found");
  // The command line blames itself, and says what was typed.
  expect(film("  margin = 0.6,"), "--set margin=-1: margin: expected", {"margin=-1"});
  expect(film(""), "--set duration=20: duration: 20 s of flight are more than the 1 s",
         {"battery=1", "duration=20"});
}

}  // namespace
}  // namespace lapwing
