// SPDX-License-Identifier: Apache-2.0
// Sections of a report that scripts state, and calls that several kinds share.
#include <gmock/gmock.h>

#include "framework/core/png.h"
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

using ::testing::HasSubstr;

class ReportSections : public MissionTest {
 protected:
  // A film whose plan adds these sections.
  static std::string with(const std::string& sections) {
    return R"(local film = require "mission.film"
local mission = film.shot { keyframes = { { position = {0, 0, 2} }, { position = {6, 0, 4} } } }
local fly = mission.plan
mission.plan = function(run)
  local plan = fly(run)
  plan:add_sections )" +
           sections + R"(
  return plan
end
return mission)";
  }
  MissionResult plan(const std::string& text) {
    const auto mission = load(text);
    mission->configure({}, {});
    return mission->plan();
  }
};

TEST_F(ReportSections, AreThoseOfTheScript) {
  Picture picture;
  picture.width = 2;
  picture.height = 1;
  picture.rgb.assign(6, 90);
  write_file_atomically(folder_ / "dot.png", encode_png(picture));
  const MissionResult result = plan(with(R"({
    { title = "Mine", blocks = {
      { type = "facts", facts = { { label = "length", value = plan.duration, unit = "s" } } },
      { type = "table", columns = { { name = "a" } }, rows = { { cells = { 3 } } } },
      { type = "image", caption = "a dot", file = "dot.png" } } },
    { title = "Second", blocks = { { type = "text", text = "words" } } } })"));
  ASSERT_EQ(result.sections.size(), 2u);
  EXPECT_EQ(result.sections[0].title, "Mine");
  ASSERT_EQ(result.sections[0].blocks.size(), 3u);
  EXPECT_EQ(std::get<Table>(result.sections[0].blocks[1]).rows[0].cells[0], TableCell(3.0));
  EXPECT_EQ(std::get<Image>(result.sections[0].blocks[2]).png, encode_png(picture));
  EXPECT_EQ(std::get<TextBlock>(result.sections[1].blocks[0]).text, "words");
  EXPECT_EQ(plan_text(result.plan).find("Mine"), std::string::npos);
}

TEST_F(ReportSections, MistakesAreNamed) {
  expect(with("{ { titel = 'x', blocks = {} } }"), "did you mean 'title'");
  expect(with("{ { title = 'x', blocks = { { type = 'tabel' } } } }"),
         "add_sections[1].blocks[1].type");
  const auto image = [](const std::string& file) {
    return with("{ { title = 'x', blocks = { { type = 'image', caption = 'c', file = '" + file +
                "' } } } }");
  };
  expect(image("no.png"), "no.png");
  expect(image("shot.lua"), "PNG");
  expect(with("{ { title = 'x', blocks = { { type = 'table', columns = { { name = 'a' } },\n"
              "rows = { { cells = { 1, 2 } } } } } } }"),
         "shot.lua:");
}

// A script that fails with what the expression gives, as text.
std::string telling(const std::string& expression) {
  return "return { kind = 'own', plan = function(run) lapwing.fail('told ' .. " + expression +
         ") end }";
}

TEST_F(ReportSections, TimesOfKeyframesComeFromTheKernel) {
  const auto times = [](const std::string& wishes, const std::string& legs) {
    return "(function() local t, n = run:keyframe_times { wishes = " + wishes + ", legs = " + legs +
           " } return t and table.concat(t, ' ') or 'refused ' .. n end)()";
  };
  expect(telling(times("{ {}, { time = 4 }, {} }", "{ 1, 2 }")), "told 0.0 4.0 6.0");
  expect(telling(times("{ {}, { latest = 0.5 }, {} }", "{ 1, 2 }")), "told refused 2");
  expect(telling(times("{ {}, { time_weight = 2 } }", "{ 1 }")), "a time_weight needs a time");
  expect(telling(times("{ {}, {} }", "{ 1, 2 }")), "2 wishes need one leg fewer, got 2");
  expect(telling(times("{ {}, {} }", "{ 0 }")), "legs[1]");
  expect(telling("table.concat(run:keyframe_stops { points = {0,0,0, 1,0,0, 2,0,0, 3,0,0},\n"
                 "keyframes = {0,0,0, 2,1,0, 3,0,0} }, ' ')"),
         "told 1 3 4");
}

TEST_F(ReportSections, VectorsStandWherePlacesDo) {
  const auto mission = load(R"(return require "mission.film".shot {
    keyframes = { { position = lapwing.vector(0, 0, 2) },
                  { position = 2 * lapwing.vector { 3, 0, 2 } } } })");
  mission->configure({}, {});
  const Value& keyframes = mission->configuration().at("keyframes");
  EXPECT_EQ(to_json(keyframes.as_list()[1].at("position"), -1), "[6.0,0.0,4.0]");
  expect(R"(return require "mission.film".shot {
    keyframes = { { position = lapwing.vector(0, 0 / 0, 2) } } })",
         "keyframes[1].position: expected a vector of finite numbers");
}

TEST_F(ReportSections, ModulesAreAskedFor) {
  const auto known = [](const std::string& name) {
    return "(function() local a, b = lapwing.has_module('" + name +
           "') return tostring(a) .. ' ' .. tostring(b) end)()";
  };
  expect(telling(known("mission.film")), "told true nil");
  expect(telling(known("mission.flim")), "told false mission.film");
  expect(telling(known("nothing.like_it")), "told false nil");
  expect(telling(known("../film")), "is not a module name");
}

}  // namespace
}  // namespace lapwing
