// SPDX-License-Identifier: Apache-2.0
// Lines that a newcomer types wrongly: one message each, with what, where, and what would be right.
#include <gmock/gmock.h>
#include <sys/stat.h>

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
    judged_alike(words, finished);
  }
};

TEST_F(Slips, WordsOfTheCommandLine) {
  slip({"run"}, "'lapwing run' wants MISSION.lua: mission script");
  slip({"export", "plan.json", "-o", "x"},
       "'lapwing export' wants --format NAME[:KEY=VALUE,...]: an exporter");
  slip({"evaluate", "explore", "--world"}, "'--world' wants NAME[:FIRST-LAST]: a scene of");
  slip({"--set", "step=1", "run", "shot.lua"},
       "'--set' is an option of 'lapwing run': write it behind that");
  slip({"explore", "--help"},
       "unknown command 'explore'; explore is a kind of mission: `lapwing new mission explore "
       "FILE.lua` ");
  slip({"help", "film"}, "'lapwing' has no command 'film'; film is a kind of mission: ");
  slip({"map", "inof", "--help"}, "unknown command 'inof'; did you mean 'info'?");
  slip({"new", "plugin", "cost", "keep_low"},
       "there is no kind of plugin 'cost'; did you mean 'cost_term'?; there are: constraint, ");
}

TEST_F(Slips, AFileOfAnotherSort) {
  slip({"run", "plan.json"},
       "'plan.json' is not a mission script, NAME.lua; a plan is judged by `lapwing verify "
       "plan.json`");
  slip({"config", "mine.yaml"},
       "'mine.yaml' is not a mission script, NAME.lua; a configuration is");
  write("bird.svg", "<svg/>");
  slip({"run", "bird.svg"},
       "'bird.svg' is not a mission script, NAME.lua; a light painting draws it: `lapwing run "
       "PAINTING.lua --set input=bird.svg`");
  slip({"config", "track.yml"}, "'track.yml' is not a mission script, NAME.lua; a configuration");
  slip({"run", "shot"}, "cannot read 'shot'; did you mean 'shot.lua'?");
  slip({"run", "shot.lua", "--config", "vehicles/solo"},
       "--config vehicles/solo: this is a vehicle, not a configuration of a mission; expected "
       "--set vehicle=vehicles/solo");
  slip({"verify", "house.obj"}, "'house.obj' is not a plan; expected a document such as plan.json");
  write("out/shot/plan.json", "{}");
  slip({"verify", "out/shot"}, "'out/shot' is a folder; its plan is 'out/shot/plan.json'");
  slip({"verify", "out"}, "'out' is a folder; expected a plan, such as plan.json");
}

// Whatever is given in place of a plan, every command that takes one says what it is and what is
// wanted, in the same words.
TEST_F(Slips, InPlaceOfAPlan) {
  struct Given {
    const char *file, *message;
  };
  const std::string wanted = "; expected a document such as plan.json in the folder of a run\n";
  write("empty.json", " \n");
  write("binary", std::string("\x7f"
                              "ELF\0\0{\"",
                              8));
  write("list.json", "[1]");
  write("settings.json", "{\"margin\": 1}");
  write("whole.json", "{\"format\": 1}");
  fs::create_directories(folder_ / "nothing");
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  const Given all[] = {
      {"shot.lua", "'shot.lua' is a script, not a plan; `lapwing run shot.lua` makes one, "},
      {"mine.yaml", "'mine.yaml' is a configuration, not a plan; expected a document such as "},
      {"nothing", "'nothing"},
      {"pipe", "cannot read 'pipe': nobody has written into it for 5 s"},
      {"empty.json", "'empty.json' is empty; expected a document such as plan.json in the "},
      {"binary", "'binary' is not a plan; expected a document such as plan.json in the folder "},
      {"list.json", "'list.json' is not a plan; expected a document such as plan.json in the "},
      {"settings.json", "'settings.json' is not a plan: JSON without `format` and `samples`; "},
      {"house.obj", "'house.obj' is not a plan; expected a document such as plan.json in the "},
      {"absent.json", ""},
      {"whole.json", "whole.json:1: "}};
  write("log.csv", "time,forward,left\n0,0,0\n");
  for (const Given& given : all) {
    const std::vector<std::vector<std::string>> commands = {
        {"verify", given.file},
        {"simulate", given.file},
        {"export", given.file, "--format", "csv", "-o", "x.csv"},
        {"race", given.file, "--pilot", "log.csv"},
        {"diff", given.file, given.file}};
    for (const std::vector<std::string>& words : commands) {
      if (words[0] != "verify" && words[0] != "diff" && given.file == std::string("pipe"))
        continue;  // 5 s each
      const Finished finished = run(words);
      EXPECT_EQ(finished.status, 2) << words[0] << " " << given.file;
      EXPECT_EQ(finished.out, "") << words[0] << " " << given.file;
      EXPECT_THAT(finished.err, testing::StartsWith(std::string("lapwing: ") + given.message))
          << words[0] << " " << given.file;
      EXPECT_THAT(finished.err, testing::HasSubstr(given.file)) << words[0];
    }
  }
  EXPECT_FALSE(fs::exists(folder_ / "x.csv"));
  slip({"verify", "nothing"}, "'nothing' is a folder; expected a plan, such as plan.json in the");
  slip({"diff", "nothing", "nothing"}, "'nothing': there is no plan 'nothing/plan.json'");
  slip({"verify", "empty.json"}, "'empty.json' is empty" + wanted);
}

TEST_F(Slips, MeshesAndScenes) {
  slip({"scene", "view", "chruch", "-o", "x.html"},
       "'chruch' is not a scene of scripts/scene (did you mean 'church'? There are arcade, "
       "church, ");
  slip({"scene", "view", "house.obj", "-o", "x.html", "--unit", "-1"},
       "--unit: expected a number of metres above 0, got -1");
  slip({"scene", "view", "house.obj", "-o", "x.html", "--up", "w"},
       "--up: expected x, y or z, got 'w'");
  slip({"evaluate", "explore", "--world", "chruch"},
       "'chruch' is not a scene of scripts/scene (did");
  write("map.lua", "return require('mission.map').of_scene {\n  scene = 'stret' }");
  slip({"run", "map.lua"},
       "map.lua:2: scene: there is no scene 'stret'; did you mean 'street'?; expected arcade, ");
}

TEST_F(Slips, Settings) {
  slip({"run", "shot.lua", "--set", "keyframes.2.time=3"},
       "--set keyframes.2.time=3: '.2' is not a key; an entry of a list is written keyframes[2]");
  slip({"run", "race.lua", "--set", "gates=[]", "--set", "keyframes=3"},
       "--set keyframes=3: keyframes: expected a list of tables, got 3");
  slip({"run", "shot.lua", "--set", "subject.distance=3"},
       "--set subject.distance=3: subject: a script's `subject` is the first of `subjects`: write "
       "subjects[1], as in --set subjects[1].distance=3");
  // A list of all keys is shown once.
  write("mine.yaml", "margn: 1\ncolour: red\nflavour: sweet\n");
  const Finished keys = run({"config", "shot.lua", "--config", "mine.yaml"});
  EXPECT_THAT(keys.err, testing::HasSubstr("mine.yaml:3: flavour: unknown key\n"));
  EXPECT_EQ(keys.err.find("known: "), keys.err.rfind("known: ")) << keys.err;
}

}  // namespace
}  // namespace lapwing
