// SPDX-License-Identifier: Apache-2.0
// Mapping missions end to end, and the commands on map files.
#include "framework/map/map_file.h"
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class Mapping : public Filming {
 protected:
  int command(const std::string& arguments) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing " + arguments + " > '" +
                             (folder_ / "stdout.json").string() + "' 2> '" +
                             (folder_ / "stderr.txt").string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  Value answer() const { return from_json(read_file(folder_ / "stdout.json"), "stdout"); }
  std::string error() const { return read_file(folder_ / "stderr.txt"); }
};

class SlowMapping : public Mapping {};

TEST_F(SlowMapping, AStreetIsMappedTheSameByBothBackends) {
  const std::string few = "--config mapping/small --set views=20";
  const Flown brick = fly("../mapping/street.lua", few, "brick");
  const Flown octomap =
      fly("../mapping/street.lua", few + " --set map=octomap --threads 1", "octomap");
  EXPECT_EQ(brick.status, 0);
  EXPECT_EQ(brick.result.at("status").as_text(), "ok");
  EXPECT_EQ(brick.result.at("map").at("resolution").as_number(), 0.2);
  EXPECT_GT(brick.result.at("map").at("occupied").as_integer(), 200);
  EXPECT_GT(brick.result.at("map").at("free").as_integer(), 2000);
  EXPECT_EQ(read_file(brick.folder / "map.ot"), read_file(octomap.folder / "map.ot"));
  EXPECT_FALSE(fs::exists(brick.folder / "plan.json"));
  const std::string report = read_file(brick.folder / "report.html");
  for (const char* section : {"By height", "Level cut", "Depth images"})
    EXPECT_NE(report.find(section), std::string::npos) << section;
}

TEST_F(SlowMapping, ASuburbCountsItsObservations) {
  const Flown flown = fly("../mapping/suburb.lua", "--config mapping/small");
  EXPECT_EQ(flown.status, 0);
  EXPECT_NE(read_file(flown.folder / "report.html").find("Certainty"), std::string::npos);
}

TEST_F(Mapping, FilesAreShownConvertedAndReadAgain) {
  const Flown flown = fly("../mapping/street.lua", "--config mapping/small --set scene=office");
  const std::string map = "'" + (flown.folder / "map.ot").string() + "'";
  ASSERT_EQ(command("map info --json " + map), 0) << error();
  EXPECT_EQ(answer().at("occupied"), flown.result.at("map").at("occupied"));
  const std::string two = "'" + (folder_ / "two.bt").string() + "'";
  ASSERT_EQ(command("map convert " + map + " -o " + two), 0) << error();
  ASSERT_EQ(command("map info --json " + two), 0) << error();
  EXPECT_EQ(answer().at("free"), flown.result.at("map").at("free"));
  EXPECT_EQ(answer().at("occupied"), flown.result.at("map").at("occupied"));
  const std::string page = (folder_ / "page.html").string();
  ASSERT_EQ(command("map view " + map + " -o '" + page + "'"), 0) << error();
  EXPECT_NE(read_file(page).find("By height"), std::string::npos);
  const Flown again = fly("../mapping/own_map.lua", "--set input=" + map, "again");
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(read_file(again.folder / "map.ot"), read_file(flown.folder / "map.ot"));
}

TEST_F(Mapping, ScenesAreShown) {
  const std::string page = (folder_ / "scene.html").string();
  ASSERT_EQ(command("scene view office --seed 3 -o '" + page + "'"), 0) << error();
  EXPECT_NE(read_file(page).find("From above"), std::string::npos);
  EXPECT_NE(read_file(page).find("is left out"), std::string::npos) << "a look under the roof";
  write_file_atomically(folder_ / "one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(command("scene view '" + (folder_ / "one.obj").string() + "' -o '" + page + "'"), 0)
      << error();
  EXPECT_NE(read_file(page).find("a scene of 1 triangle"), std::string::npos);
  write_file_atomically(folder_ / "none.obj", "v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n");
  fs::remove(page);
  EXPECT_EQ(command("scene view '" + (folder_ / "none.obj").string() + "' -o '" + page + "'"), 2);
  EXPECT_NE(error().find("none.obj"), std::string::npos) << error();
  EXPECT_FALSE(fs::exists(page));
}

TEST_F(Mapping, WhatIsMissingOrBrokenIsSaid) {
  const std::string examples = (kExamples / "../mapping/").string();
  EXPECT_EQ(command("run " + examples + "own_map.lua"), 2);
  EXPECT_NE(error().find("--set input=PATH"), std::string::npos) << error();
  EXPECT_EQ(command("run " + examples + "own_depth.lua --set input=nowhere"), 2);
  EXPECT_NE(error().find("nowhere"), std::string::npos) << error();
  // What the mission settles cannot be set in the backend, not even to the same value.
  for (const char* value : {"0.1", "0.2"}) {
    EXPECT_EQ(command("run " + examples + "street.lua --set map.resolution=" + value), 2);
    EXPECT_NE(
        error().find("map.resolution: it is an option of the mission: set resolution instead"),
        std::string::npos)
        << error();
  }
  EXPECT_EQ(command("run " + examples + "street.lua --set map.maximum_range=3"), 2);
  EXPECT_NE(error().find("set sensor.range instead"), std::string::npos) << error();
  EXPECT_EQ(command("run " + examples + "own_map.lua --set input=x.bt --set map.resolution=0.5"),
            2);
  EXPECT_NE(error().find("map.resolution: the file determines it"), std::string::npos) << error();
  EXPECT_EQ(command("run " + examples + "street.lua --set scene=walls"), 2);
  EXPECT_NE(error().find("'walls' is a part of scenes"), std::string::npos) << error();
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(LAPWING_SOURCE_DIR) / "scripts/scene"))
    if (entry.path().extension() == ".lua" &&
        read_file(entry.path()).find("\nreturn function(options)") != std::string::npos) {
      EXPECT_NE(error().find(entry.path().stem().string()), std::string::npos) << error();
    }
  EXPECT_EQ(command("run " + examples + "street.lua --set resolution=0"), 2);
  EXPECT_NE(error().find("resolution"), std::string::npos) << error();
  write_file_atomically(folder_ / "cut.ot", "# Octomap OcTree file\nid OcTree\nsize 9\nres 0.1\n");
  EXPECT_EQ(command("map info '" + (folder_ / "cut.ot").string() + "'"), 2);
  EXPECT_NE(error().find("cut.ot"), std::string::npos) << error();
}

TEST_F(Mapping, RealFilesGiveTheSameInBothBackends) {
  if (data_folder().empty()) GTEST_SKIP() << "LAPWING_DATA names no folder with maps";
  for (const std::string& example : {std::string("own_map.lua --set input=maps/geb079.bt"),
                                     std::string("own_depth.lua --set input=depth")}) {
    const std::size_t space = example.find(' ');
    const std::string script = "../mapping/" + example.substr(0, space);
    const std::string input = example.substr(space + 1);
    const Flown brick = fly(script, input, "brick");
    const Flown octomap = fly(script, input + " --set map=octomap", "octomap");
    EXPECT_EQ(brick.status, 0) << example;
    EXPECT_EQ(read_file(brick.folder / "map.ot"), read_file(octomap.folder / "map.ot")) << example;
  }
}

}  // namespace
}  // namespace lapwing
