// SPDX-License-Identifier: Apache-2.0
// What a script may get wrong in a term of its own: file, line, and what to write instead.
#include "framework/core/log.h"
#include "tests/mission/term_fixture.h"

namespace lapwing {
namespace {

// A cost whose function has this body, its first line being line 3 of the script.
std::string cost(const std::string& body) {
  return "p:add_cost { name = 'mine', residual = function(s)\n" + body + "\nend }";
}

TEST_F(TermTest, ComparingIsRefused) {
  refuses(
      cost("  if s.position.z > 3 then return 1 end\n  return 0"),
      "shot.lua:3: cost 'mine': a comparison would decide once, while the function is recorded, "
      "and not at every stage: write lapwing.where(x, a, b)");
  refuses(cost("  return s.position.z <= 3"), "shot.lua:3: cost 'mine': a comparison");
  refuses(cost("  return s.yaw == s.yaw_rate and 1 or 0"), "a comparison would decide once");
  refuses(cost("  return lapwing.where(2 > 1, s.yaw, 0)"), "write x - 3 for x > 3");
  refuses(cost("  return s.yaw % 2"), "'%' and '//' jump");
  refuses(cost("  return 'z' .. s.yaw"), "cannot be joined to a text");
}

// What Lua lets no type trap is found on plain numbers.
TEST_F(TermTest, DecidingIsFoundOut) {
  refuses(cost("  if s.yaw == 0 then return 1 end\n  return s.yaw"),
          "shot.lua:2: cost 'mine': on plain numbers result 1 is 1, as recorded 0, where yaw = 0: "
          "the function decides by a value (if, ==, and, or), which is done once");
  refuses(cost("  if s.position.x == 2 then return 1, 2 end\n  return s.yaw"),
          "on plain numbers it returns 2 numbers, on a stage 1");
  // Whatever the number is that it compares with: it stands in a line, or in a local.
  for (const char* number : {"3", "-4", "12.5"})
    refuses(
        cost("  if s.position.z == " + std::string(number) + " then return 9 end\n  return s.yaw"),
        "the function decides");
  refuses("local limit <const> = 77\nlocal most = limit + 0.5\n" +
              cost("  if s.position.z == most then return 9 end\n  return s.yaw"),
          "the function decides");
  refuses(cost("  return s.yaw * math.random()"), "depends on something that changes from call");
  refuses(cost("  return type(s.yaw) == 'number' and 1 or s.yaw"), "the function decides");
  refuses("local n = 0\n" + cost("  n = n + 1\n  return n * s.yaw"), "the function decides");
  refuses("local kept\n" + cost("  kept = kept or s.yaw\n  return kept - s.yaw"),
          "a value of a stage was kept from another term or another call");
}

TEST_F(TermTest, WrongShapesAreNamed) {
  refuses(
      cost("  return s.position + s.yaw"),
      "shot.lua:3: cost 'mine': '+' of a vector of 3 numbers and a number: both must be vectors, "
      "or both numbers");
  refuses(cost("  return s.position - {1, 2}"),
          "'-' of a vector of 3 numbers and a list of 2: their sizes differ");
  refuses(cost("  return s.position * s.velocity"), "write lapwing.dot(a, b)");
  refuses(cost("  return 1 / s.position"), "a number divided by a vector");
  refuses(cost("  return lapwing.cross(s.position, {1, 2})"),
          "lapwing.cross: expected a vector of 3 numbers, got a list of 2");
  refuses(cost("  return s.position.q"),
          "a vector of 3 numbers has no 'q'; it has x, y, z, or 1 to 3");
  refuses(cost("  return s.yaw.z"), "this is one number and has no 'z'");
  refuses(cost("  return lapwing.sin(s.position)"),
          "lapwing.sin: expected a number, got a vector of 3 numbers");
  refuses(cost("  return lapwing.max()"), "lapwing.max: expected 1 or more values, got 0");
  refuses(cost("  s.position.x = 2\n  return 1"), "cannot be changed");
}

TEST_F(TermTest, WrongNamesAndResultsAreNamed) {
  refuses(cost("\n  return s.positon.z"), "shot.lua:4: cost 'mine': no block 'positon'");
  refuses(cost("\n  return s.positon.z"), "position");
  refuses(
      cost("  return 'high'"),
      "shot.lua:2: cost 'mine': expected the function to return numbers or vectors, got a string");
  refuses(cost("  local x = s.yaw"), "the function returns nothing");
  refuses(cost("  return s.yaw, nil"), "got nothing");
  refuses(cost("  return s"), "got a stage");
  refuses(cost("  return 0 / 0"), "returns no finite number whatever the stage is");
  refuses(cost("  return lapwing.log(-1 - s.yaw ^ 2)"), "is not a finite number at any of ");
  refuses(
      cost("  return math.sin(s.yaw)"),
      "shot.lua:3: cost 'mine': bad argument #1 to 'sin' (number expected, got value of a stage "
      "(which the functions of `lapwing` take)): write lapwing.sin");
  refuses(cost("  return lapwing.sinn(s.yaw)"),
          "shot.lua:3: cost 'mine': attempt to call a nil value (field 'sinn'); did you mean "
          "lapwing.sin?");
  refuses(cost("  local x = s.yaw\n  for i = 1, 2e6 do x = x + lapwing.sin(x * i) end\n  return x"),
          "cost 'mine': ");
  refuses(cost("  while true do end"), "cost 'mine': ");
  refuses(cost("  return s.position[4]"), "a vector of 3 numbers has no '4'");
  refuses(cost("  return s[11].yaw"), "s[11]: the last neighbour that there can be here is s[10]");
  refuses(cost("  return s[0.5].yaw"), "expected a whole number, at least 0");
  refuses(cost("  return s:subject('wlaker')"), "did you mean 'walker'?");
  refuses(cost("  return s:distance(s.position, 'rokc')"), "did you mean 'rock'?");
  refuses(
      "p:add_cost { name = 'mine', parameters = { height = 2 }, residual = function(s, q)\n"
      "  return s.yaw - q.heigth\nend }",
      "shot.lua:3: cost 'mine': no parameter 'heigth' in its `parameters`; did you mean 'height'?");
}

// A film of two keyframes with one cost, whose function is line 4.
std::string flight(const std::string& from, const std::string& to, const std::string& residual) {
  return "local film = require 'mission.film'\nreturn film.shot { name = 'f', keyframes = { { "
         "position = "
         "{" +
         from + "} }, { position = {" + to +
         "} } },\ncosts = { { name = 'mine', weight = 0.01,\n"
         "residual = function(s) return " +
         residual + " end } } }";
}

// Numbers beyond those of the seeded points are tried where the flight is.
TEST_F(TermTest, ATermThatHasValuesOnlyWhereTheFlightIsIsTaken) {
  const auto mission =
      load(flight("0, 0, 120", "8, 0, 125", "lapwing.sqrt(s.position.z - 100) - 4"));
  mission->configure({}, {});
  EXPECT_EQ(mission->plan().report.status, SolveStatus::optimal);
  expect(flight("0, 0, 20", "8, 0, 25", "lapwing.sqrt(s.position.z - 200)"),
         "shot.lua:4: cost 'mine': a value of result 1 is not a finite number at 0 s");
}

// A value or a slope that is none in a solve is the script's fault, not a plugin's.
TEST_F(TermTest, NumbersThatAreNoneInASolveAreNamed) {
  const std::string log = error(flight("0, 0, 2", "8, 0, 12", "lapwing.log(s.position.z - 5)"));
  EXPECT_EQ(log.rfind("shot.lua:4: cost 'mine': a value of result 1 is not a "
                      "finite number at 0 s, where position = {0, 0, 2}: keep roots",
                      0),
            0u)
      << log;
  for (const char* kinked : {"lapwing.sqrt(s.position.y)", "s.position.y ^ 1.5"}) {
    const std::string root = error(flight("0, 0, 2", "8, 0, 12", kinked));
    EXPECT_NE(
        root.find("shot.lua:4: cost 'mine': the derivative of result 1 is not a finite number at "),
        root.npos)
        << root;
    EXPECT_NE(root.find("write lapwing.sqrt(lapwing.max(x, 0) + 1e-6) for lapwing.sqrt(x)"),
              root.npos)
        << root;
  }
  // What is written instead flies.
  const auto mission =
      load(flight("0, 0, 2", "8, 0, 12", "lapwing.sqrt(lapwing.max(s.position.y, 0) + 1e-6)"));
  mission->configure({}, {});
  EXPECT_EQ(mission->plan().report.status, SolveStatus::optimal);
}

// What is allowed, but hardly meant.
TEST_F(TermTest, ConstantAndHugeTermsAreWarnedOf) {
  const auto warned = [&](const std::string& terms) {
    const logging::Capture capture;
    stated(terms);
    return capture.text();
  };
  EXPECT_NE(warned(cost("  return 3")).find("shot.lua:2: cost 'mine': is the same number whatever"),
            std::string::npos);
  const std::string huge = "  local x = s.yaw\n  for i = 1, 3e4 do x = x + lapwing.sin(x) end\n";
  EXPECT_NE(
      warned(cost(huge + "  return x")).find("operations at every stage; solving will be slow"),
      std::string::npos);
  EXPECT_EQ(warned(cost("  return s.yaw")).find("cost 'mine'"), std::string::npos);
}

TEST_F(TermTest, WrongTablesAreNamed) {
  refuses("p:add_cost { name = 'mine', value = function(s) return s.yaw end }",
          "shot.lua:2: add_cost: 'value' is a function; did you mean `residual`");
  refuses("p:add_cost { name = 'mine', residul = function(s) return s.yaw end }",
          "add_cost: 'residul' is a function; did you mean `residual`");
  refuses("p:add_constraint { name = 'mine', upper = 1, residual = function(s) return s.yaw end }",
          "add_constraint: 'residual' is a function; did you mean `value`");
  refuses(
      "p:add_cost { name = 'mine', residual = lapwing.sin }",
      "shot.lua:2: add_cost 'mine': residual: expected a function of a stage, function(s) return "
      "... end, got one that is not written in Lua");
  refuses(
      "local terms = {\n  { name = 'mine', weigth = 2,\n    residual = function(s) return s.yaw "
      "end } }\nfor _, t in ipairs(terms) do p:add_cost(t) end",
      "shot.lua:4: add_cost 'mine'.weigth: unknown key; did you mean 'weight'?");
  const std::string twice = "{ name = 'mine', residual = function(s) return s.yaw end }";
  refuses("p:add_cost " + twice + "\np:add_cost " + twice,
          "shot.lua:3: add_cost 'mine': there is a term of that name already (shot.lua:2)");
  refuses(
      "p:add_cost { name = 'mine', residual = 'position.z' }",
      "shot.lua:2: add_cost 'mine': residual: expected a function of a stage, function(s) return "
      "... end, got a string");
  refuses("p:add_cost { residual = function(s) return s.yaw end }", "name: missing");
  refuses("p:add_cost { name = 'mine', wieght = 2, residual = function(s) return s.yaw end }",
          "add_cost 'mine'.wieght: unknown key; did you mean 'weight'?");
  refuses("p:add_cost { name = 'mine', type = 'keyframe', residual = function(s) return 1 end }",
          "add_cost: give a plugin's `type` or a `residual`, not both");
  refuses("p:add_constraint { name = 'mine', value = function(s) return s.yaw end }",
          "add_constraint 'mine': give `lower`, `upper` or both");
  refuses(
      "p:add_constraint { name = 'mine', lower = {0, 1}, value = function(s) return s.yaw end }",
      "constraint 'mine': lower has 2 numbers, the function returns 1");
  refuses(
      "p:add_constraint { name = 'mine', lower = 1, upper = 0, value = function(s) return "
      "s.yaw end }",
      "constraint 'mine': lower is above upper");
  refuses("p:add_cost { name = 'mine', times = {0.5}, residual = function(s) return s[1].yaw end }",
          "at given times there is no neighbouring stage to read");
  refuses("p:add_cost { name = 'mine', residual = function(s) p:add_cost {} return 1 end }",
          "the problem is finished");
}

// Terms that a film's script brings along.
TEST_F(TermTest, AFilmTakesTermsOfItsOwn) {
  const std::string text = film(R"(  weights = { smoothness = 1e-3 },
  costs = { { name = "keep_low", weight = 50,
              residual = function(s) return lapwing.max(s.position.z - 3, 0) end },
            { type = "input_effort", weight = 0.1 } },
  constraints = { { name = "side", upper = 0.2, value = function(s) return s.position.y end } },)");
  const auto highest = [&](std::vector<std::string> overrides) {
    const auto mission = load(text);
    mission->configure({}, overrides);
    const MissionResult result = mission->plan();
    EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
    double sum = 0;
    for (const Sample& sample : result.plan.trajectory.samples) sum += sample.position.z();
    return sum;
  };
  EXPECT_LT(highest({}), highest({"costs[1].weight=0"}));
  expect(film("costs = 3,"), "shot.lua:2: costs: expected a list of tables, got number");
  expect(film("costs = { { weight = 2 } },"), "add_cost.type: missing");
  expect(film("costs = { { name = 'a', residual = function(s) return s.positon end } },"),
         "shot.lua:8: cost 'a': no block 'positon'");
  expect(film("constraints = { { name = 'a', weight = 1 } },"),
         "constraints[1]: a constraint has no weight");
}

}  // namespace
}  // namespace lapwing
