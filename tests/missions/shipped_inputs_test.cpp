// SPDX-License-Identifier: Apache-2.0
// Files of the kinds that users bring, made for these tests (tests/data), through the program: what
// other tests do with real ones where LAPWING_DATA names them.
#include "tests/missions/race_fixture.h"

namespace lapwing {
namespace {

const std::string kShipped = LAPWING_SOURCE_DIR "/tests/data";

class ShippedInputs : public Race {
 protected:
  Flown fly_shot(const std::string& name, const std::string& more = "", int worst = 1) {
    return fly("own_shot.lua", "--data '" + kShipped + "' --set input=" + name + ".json " + more,
               "out", worst);
  }
  Flown fly_script(const std::string& text, const std::string& more = "") {
    write_file_atomically(folder_ / "script.lua", text);
    return fly((folder_ / "script.lua").string(), "--data '" + kShipped + "' " + more);
  }
};

// In metres about a place, by latitude and longitude alone, one keyframe, a pause.
TEST_F(ShippedInputs, ShotsAreCertifiedWhereTheVehicleCanFollow) {
  for (const char* name : {"old_mill", "harbour", "one_place", "pause"}) {
    SCOPED_TRACE(name);
    const Flown flown = fly_shot(name);
    expect_certified(flown);
    EXPECT_EQ(flown.result.at("film").at("stretch").as_number(), 1);
  }
}

TEST_F(ShippedInputs, AShotEndsAtItsLastKeyframeAndStandsWhereItSays) {
  const Flown flown = fly_shot("old_mill");  // totalTimeMs says 60 s
  const Plan plan = read_plan(flown.folder / "plan.json");
  EXPECT_NEAR(plan.trajectory.duration(), 40, 1e-6);
  ASSERT_TRUE(plan.geodetic_origin);
  EXPECT_NEAR(plan.geodetic_origin->latitude_deg, 46.5191, 1e-9);
  // The third keyframe: 52 m north, 2 m east, 15 m up.
  EXPECT_LT((plan.task.keyframes.at(2).position - Eigen::Vector3d(2, 52, 15)).norm(), 1e-9);
}

TEST_F(ShippedInputs, LatitudeAndLongitudeAreMetresFromTheFirstKeyframe) {
  const Flown flown = fly_shot("harbour");
  const Plan plan = read_plan(flown.folder / "plan.json");
  // Made with a sphere of 6371 km, 21 m and 39 m away: a quarter of a metre from an ellipsoid's.
  const Eigen::Vector3d last = plan.task.keyframes.at(2).position;
  EXPECT_LT((last - Eigen::Vector3d(40, 28, last.z())).norm(), 0.25) << last.transpose();
}

TEST_F(ShippedInputs, AShotThatIsTooFastIsStretched) {
  const Flown flown = fly_shot("too_fast");
  expect_certified(flown);
  EXPECT_GT(flown.result.at("film").at("stretch").as_number(), 1.75) << "70 m in 4 s, at 10 m/s";
  EXPECT_LT(flown.result.at("film").at("stretch").as_number(), 2.5);
}

TEST_F(ShippedInputs, AMapAndDepthImagesGiveTheSameInBothBackends) {
  for (const std::string& example : {std::string("own_map.lua --set input=maps/room.bt"),
                                     std::string("own_depth.lua --set input=depth")}) {
    const std::size_t space = example.find(' ');
    const std::string script = "../mapping/" + example.substr(0, space);
    const std::string input = "--data '" + kShipped + "'" + example.substr(space);
    const Flown brick = fly(script, input, "brick");
    const Flown octomap = fly(script, input + " --set map=octomap", "octomap");
    EXPECT_EQ(brick.status, 0) << example;
    EXPECT_EQ(read_file(brick.folder / "map.ot"), read_file(octomap.folder / "map.ot")) << example;
  }
}

TEST_F(ShippedInputs, AFilmIsFlownThroughAMappedRoom) {
  const Flown flown = fly_script(R"(return require "mission.film".shot {
    name = "room", vehicle = "vehicles/solo", margin = 0.25,
    keyframes = { { position = {4.2, 1.8, 1.4} }, { position = {1.8, 3.2, 1.4} } },
    obstacles = { { type = "map", file = "maps/room.bt" } } })");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  const Plan plan = read_plan(flown.folder / "plan.json");
  const Certificate certificate = verify(plan, flown.folder);
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_GE(certificate.find("clearance")->worst.value(), 0.249);
}

TEST_F(ShippedInputs, CoursesOfFilesAreFlown) {
  for (const char* name : {"chicane", "barn"}) {
    SCOPED_TRACE(name);
    const Flown flown = fly_script(std::string("return require 'mission.race'.course { name = '") +
                                   name + "', input = 'tracks/" + name + ".yaml' }");
    expect_certified(flown);
    EXPECT_LT(time_of(flown), 6);
  }
}

TEST_F(ShippedInputs, LettersOfAFontFileAreDrawn) {
  const Flown flown = fly_script(
      "return require 'mission.light_painting'.text { name = 'letters', height = 2, "
      "font = 'strokes/plain.jhf', text = 'COAL' }");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  EXPECT_LE(flown.result.at("light_painting").at("mean_error").as_number(), 0.02);
}

}  // namespace
}  // namespace lapwing
