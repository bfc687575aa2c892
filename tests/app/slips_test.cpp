// Lines that a newcomer types wrongly: one message each, with what, where, and what would be right.
#include <gmock/gmock.h>

#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class Slips : public CommandLine {
 protected:
  void SetUp() override {
    write("shot.lua", film("name = 'shot'"));
    write("race.lua",
          "return require('mission.race').course { name = 'race', start = {0, 0, 1}, finish = {8, "
          "0, 1},\n  gates = { { shape = 'ball', position = {4, 1, 2}, radius = 0.3 } } }\n");
    write("house.obj", "hello");
    write("plan.json", "{\"format\": 1}");
    write("mine.yaml", "margin: 1\n");
  }
  // One line, and below it at most where help is found.
  void slip(const std::vector<std::string>& words, const std::string& message) {
    const Finished finished = run(words);
    EXPECT_EQ(finished.status, 2) << finished.err;
    EXPECT_THAT(finished.err, testing::StartsWith("lapwing: " + message)) << words[0];
    EXPECT_LE(std::count(finished.err.begin(), finished.err.end(), '\n'), 2) << finished.err;
    EXPECT_LT(finished.err.size(), 700u) << finished.err;
  }
};

TEST_F(Slips, WordsOfTheCommandLine) {
  slip({"run"}, "'lapwing run' wants MISSION.lua: mission script");
  slip({"export", "plan.json", "-o", "x"},
       "'lapwing export' wants --format NAME: name of an exporter");
  slip({"evaluate", "explore", "--world"}, "'--world' wants NAME[:FIRST-LAST]: a scene of");
  slip({"--set", "step=1", "run", "shot.lua"},
       "'--set' is an option of 'lapwing run': write it behind that");
  slip({"new", "plugin", "cost", "keep_low"},
       "there is no kind of plugin 'cost'; did you mean 'cost_term'?; there are: constraint, ");
}

TEST_F(Slips, AFileOfAnotherSort) {
  slip(
      {"run", "plan.json"},
      "'plan.json' is no mission script, NAME.lua; a plan is judged by `lapwing verify plan.json`");
  slip({"config", "mine.yaml"}, "'mine.yaml' is no mission script, NAME.lua; a configuration is");
  slip({"run", "shot"}, "cannot read 'shot'; did you mean 'shot.lua'?");
  slip({"run", "shot.lua", "--config", "vehicles/solo"},
       "--config vehicles/solo: this is a vehicle, not a configuration of a mission; expected "
       "--set vehicle=vehicles/solo");
  slip({"verify", "house.obj"}, "'house.obj' is no plan; expected a document such as plan.json");
  write("out/shot/plan.json", "{}");
  slip({"verify", "out/shot"}, "'out/shot' is a folder; its plan is 'out/shot/plan.json'");
  slip({"verify", "out"}, "'out' is a folder; expected a plan, such as plan.json");
}

TEST_F(Slips, MeshesAndScenes) {
  slip({"scene", "view", "chruch", "-o", "x.html"},
       "'chruch' is no scene of scripts/scene (did you mean 'church'? There are arcade, church, ");
  slip({"scene", "view", "house.obj", "-o", "x.html", "--unit", "-1"},
       "--unit: expected a number of metres above 0, got -1");
  slip({"scene", "view", "house.obj", "-o", "x.html", "--up", "w"},
       "--up: expected x, y or z, got 'w'");
  slip({"evaluate", "explore", "--world", "chruch"}, "'chruch' is no scene of scripts/scene (did");
  write("map.lua", "return require('mission.map').of_scene {\n  scene = 'stret' }");
  slip({"run", "map.lua"},
       "map.lua:1: scene: there is no scene 'stret'; did you mean 'street'?; expected arcade, ");
}

TEST_F(Slips, Settings) {
  slip({"run", "shot.lua", "--set", "keyframes.2.time=3"},
       "--set keyframes.2.time=3: '.2' is no key; an entry of a list is written keyframes[2]");
  slip({"run", "race.lua", "--set", "gates=[]", "--set", "keyframes=3"},
       "--set: keyframes: expected a list of tables, got 3");
  // A list of all keys is shown once.
  write("mine.yaml", "margn: 1\ncolour: red\nflavour: sweet\n");
  const Finished keys = run({"config", "shot.lua", "--config", "mine.yaml"});
  EXPECT_THAT(keys.err, testing::HasSubstr("mine.yaml:3: flavour: unknown key\n"));
  EXPECT_EQ(keys.err.find("known: "), keys.err.rfind("known: ")) << keys.err;
}

}  // namespace
}  // namespace lapwing
