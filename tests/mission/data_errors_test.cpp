// SPDX-License-Identifier: Apache-2.0
// Errors in data files name file, line and the nearest key.
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

class DataErrors : public MissionTest {
 protected:
  std::string plan(const std::string& body) {
    return "return { kind = 'film', name = 'test', plan = function(run)\n" + body + "\nend }";
  }
  void write(const std::string& name, const std::string& text) {
    write_file_atomically(folder_ / name, text);
  }
};

TEST_F(DataErrors, AFileFailsOnTheLineOfItsValue) {
  write("a.yaml", "gates:\n  - {shape: ball}\n  - shape: ring\n    radius: 3\n");
  const std::string open = "local given, file = lapwing.read_yaml('a.yaml')\n";
  expect(plan(open + "file:fail('gates[2].radius', 'too large')"),
         "a.yaml:4: gates[2].radius: too large");
  expect(plan(open + "file:fail('gates[7].radius', 'is missing')"),
         "a.yaml:1: gates[7].radius: is missing");
  expect(plan(open + "file:fail('gates[2].raduis', 'missing')"),
         "missing; did you mean 'raduis' by 'radius' on line 4?");
  expect(plan(open + "file:fail('', 'is not a course')"), "a.yaml:1: is not a course");
}

TEST_F(DataErrors, ATableIsCheckedAsOptionsAre) {
  write("b.json", "{\"ring\": {\n\"raduis\": 3}}");
  const std::string open = "local given, file = lapwing.read_json('b.json')\n";
  const std::string table =
      "{ { name = 'radius', type = 'number', unit = 'm', default = 2, summary = 'r' } }";
  expect(plan(open + "file:check('ring', " + table + ")"),
         "b.json:2: ring.raduis: unknown key; did you mean 'radius'?");
  expect(plan(open + "file:check('rnig', " + table + ")"), "rnig: missing; expected a table");
  write("b.json", "{\"ring\": {}}");
  expect(plan(open + "lapwing.fail(tostring(file:check('ring', " + table + ").radius))"), "2");
}

TEST_F(DataErrors, OtherKeysAreRefusedOrSlipsAlone) {
  write("c.yaml", "start: 1\nfinsih: 2\nnote: 3\n");
  const std::string open = "local given, file = lapwing.read_yaml('c.yaml')\n";
  expect(plan(open + "file:expect_keys('', { 'start', 'finish' })"),
         "c.yaml:2: finsih: unknown key; did you mean 'finish'?");
  expect(plan(open + "file:expect_keys('', { 'start', 'finish' })"),
         "c.yaml:3: note: unknown key; known: start, finish");
  const std::string slips = error(plan(open + "file:expect_keys('', { 'start', 'finish' }, true)"));
  EXPECT_EQ(slips.find("note"), std::string::npos) << slips;
}

TEST_F(DataErrors, AShotNamesItsKeyframe) {
  const auto shot = [&](const std::string& keyframe) {
    write(
        "shot.json", R"({"keyframeTimes": [0, 5], "refLLH": {"lat": 47, "lng": 8, "altitude": 400},
"keyFrameList": [
{"lookFromNED": {"n": 0, "e": 0, "d": -5}, "lookAtNED": {"n": 10, "e": 0, "d": 0}},
)" + keyframe + "]}");
    return error(
        "local film = require 'mission.film'\nreturn film.from_file { file = "
        "'shot.json' }");
  };
  EXPECT_NE(shot(R"({"lookFormNED": {"n": 0, "e": 12, "d": -8}})")
                .find("shot.json:4: keyFrameList[2].lookFormNED: unknown key; did you mean "
                      "'lookFromNED'?"),
            std::string::npos);
  EXPECT_NE(shot(R"({"lookFromNED": {"n": 0, "e": "x", "d": -8}})")
                .find("shot.json:4: keyFrameList[2].lookFromNED.e: expected a number"),
            std::string::npos);
  EXPECT_NE(shot(R"({"lookAtNED": {"n": 0, "e": 1, "d": -8}})")
                .find("shot.json:4: keyFrameList[2].lookFromNED: missing"),
            std::string::npos);
}

}  // namespace
}  // namespace lapwing
