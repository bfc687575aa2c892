// SPDX-License-Identifier: Apache-2.0
// Moves that a scene recommends for explorations: applied, named, and told apart on resuming.
#include <gmock/gmock.h>

#include "tests/missions/exploring_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

class SceneMoves : public Exploring {
 protected:
  // A closed room, 3 m high: no place for the standard moves.
  std::string room(
      const std::string& moves = "scene:moves { step = 0.8, body = 0.5, clear = 1.5 }") {
    const fs::path script = folder_ / "room.lua";
    write_file_atomically(script, R"(return function(options)
  local scene = lapwing.scene { name = "room", seed = options.seed or 1 }
  for _, wall in ipairs { {{0,0,0},{9,7,0.1}}, {{0,0,2.9},{9,7,3}}, {{0,0,0},{0.1,7,3}},
                          {{8.9,0,0},{9,7,3}}, {{0,0,0},{9,0.1,3}}, {{0,6.9,0},{9,7,3}},
                          {{4,2,0},{4.4,5,3}} } do scene:box(wall[1], wall[2]) end
  scene:region({0, 0, 0}, {9, 7, 3})
  )" + moves + "\n  return scene\nend\n");
    return script.string();
  }
  struct Said {
    int status;
    std::string out, err;
  };
  Said evaluate(const std::string& more) {
    const std::string out = (folder_ / "out.txt").string(), err = (folder_ / "err.txt").string();
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing evaluate explore " +
                             "--utility frontier --episodes 1 --steps 3 " + more + " > '" + out +
                             "' 2> '" + err + "'";
    const int status = WEXITSTATUS(std::system(line.c_str()));
    return {status, read_file(out), read_file(err)};
  }
  std::string in(const char* folder) { return " -o '" + (folder_ / folder).string() + "' "; }
};

TEST_F(SceneMoves, AreAppliedAndNamedWhereTheUserSaysNothing) {
  const Said said = evaluate("--world '" + room() + "'" + in("own"));
  ASSERT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.out,
              HasSubstr("room.lua 1 was explored with the moves that its scene recommends: "
                        "step 0.8"));
  const Value settings = from_json(read_file(folder_ / "own/settings.json"), "settings");
  EXPECT_EQ(settings.at("moves").at("step").as_number(), 2.5);
  EXPECT_EQ(settings.at("world_moves").at("room.lua 1").at("clear").as_number(), 1.5);
  EXPECT_EQ(settings.at("world_moves").at("room.lua 1").at("turn_deg").as_number(), 25);
  EXPECT_EQ(evaluate("--resume --world '" + room() + "'" + in("own")).status, 0);
}

TEST_F(SceneMoves, TheUsersOwnGoBeforeThem) {
  const Said said = evaluate("--moves step=0.5 --json --world '" + room() + "'" + in("mixed"));
  ASSERT_EQ(said.status, 0) << said.err;
  const Value moves = from_json(said.out, "out").at("world_moves").at("room.lua 1");
  EXPECT_EQ(moves.at("step").as_number(), 0.5);
  EXPECT_EQ(moves.at("body").as_number(), 0.5);
}

TEST_F(SceneMoves, AFolderOfOtherMovesIsNotGoneOnWith) {
  const std::string stated = "--moves step=0.8 --moves body=0.5 --moves clear=1.5 ";
  ASSERT_EQ(evaluate(stated + "--world '" + room("") + "'" + in("old")).status, 0);
  const Value settings = from_json(read_file(folder_ / "old/settings.json"), "settings");
  EXPECT_EQ(settings.find("world_moves"), nullptr);  // as folders were before scenes had moves
  EXPECT_EQ(evaluate(stated + "--resume --world '" + room() + "'" + in("old")).status, 0);
  const Said other = evaluate(
      "--moves step=0.8 --moves body=0.5 --moves clear=1.5 --resume "
      "--world '" +
      room() + "' --moves turn_deg=30" + in("old"));
  EXPECT_EQ(other.status, 2);
  ASSERT_EQ(evaluate("--world '" + room() + "'" + in("own")).status, 0);
  const std::string smaller = "scene:moves { step = 0.7, body = 0.5, clear = 1.5 }";
  const Said changed = evaluate("--resume --world '" + room(smaller) + "'" + in("own"));
  EXPECT_EQ(changed.status, 2);
  EXPECT_THAT(changed.err, HasSubstr("the moves in room.lua 1 are step 0.8"));
}

TEST_F(SceneMoves, WithoutThemTheHintNamesTheOptions) {
  const Said said = evaluate("--world '" + room("") + "'" + in("none"));
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(said.err, HasSubstr("world 'room.lua 1': found no start"));
  EXPECT_THAT(said.err, HasSubstr("--moves clear=3 --moves step=1.25"));
  EXPECT_THAT(said.err, HasSubstr("the box of 6 m that must be free"));
}

TEST_F(SceneMoves, AMissionInAShippedSceneKnowsThem) {
  write_file_atomically(folder_ / "office.lua",
                        "return require 'mission.explore'.of_scene { name = 'office', scene = "
                        "'office' }");
  const Flown flown = fly((folder_ / "office.lua").string(),
                          "--config explore/small --set compare=false --set steps=2");
  ASSERT_EQ(flown.status, 0) << to_json(flown.result);
  bool named = false;
  for (const Value& note : flown.result.at("notes").as_list())
    named = named || note.as_text().find("moves that the scene 'office' recommends: step = 0.7") !=
                         std::string::npos;
  EXPECT_TRUE(named) << to_json(flown.result.at("notes"));
  // What the user says of them is said at the option.
  const Flown big = fly((folder_ / "office.lua").string(),
                        "--config explore/small --set compare=false --set moves.clear=8", "big", 2);
  EXPECT_EQ(big.status, 2);
}

}  // namespace
}  // namespace lapwing
