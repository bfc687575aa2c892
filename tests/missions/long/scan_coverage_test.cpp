// SPDX-License-Identifier: Apache-2.0
// The default first flight, and what less effort leaves as it is.
#include "tests/missions/scan_house.h"

namespace lapwing {
namespace {

TEST_F(Covering, ACrosshatchLooksFourWaysAndTakesNoMoreThanIsAsked) {
  const Value all = of_house("--set 'flights=[{pattern: crosshatch}]'", "all");
  const Value fewer = of_house("--set 'flights=[{pattern: crosshatch, views: 24}]'", "fewer");
  const auto images = [](const Value& answer) {
    return std::stoi(answer.at("notes").as_list().front().as_text());
  };
  EXPECT_GT(images(all), 24);
  EXPECT_LE(images(fewer), 24);
  EXPECT_GT(images(fewer), 8);
  EXPECT_EQ(run("--set input=house.obj --set ground=true --data '" + folder_.string() +
                    "' --set 'flights=[{pattern: crosshatch, views: 2}]'",
                "house.lua", "two"),
            2);
  EXPECT_THAT(error(), HasSubstr("a crosshatch needs at least"));
}

// The images that are planned are those of the camera, whatever effort is made.
TEST_F(Covering, LessEffortLeavesTheCameraOfThePlan) {
  of_house(
      "--set camera.width=160 --set camera.height=120 --set camera.focal=92 "
      "--set effort.pixels=80");
  const Plan made = read_plan(folder_ / "out/plan.json");
  EXPECT_EQ(made.task.scan->camera.width, 160);
  EXPECT_EQ(made.task.scan->camera.focal_x, 92);
}

// Rays of few pixels are farther apart than small voxels: the gaps between them hide nothing.
TEST_F(Covering, AClosedCourtSeenByFewPixelsHasNoUnknown) {
  write_file_atomically(folder_ / "house.obj", kCourtMesh);
  const Value answer = of_house("--set resolution=0.2");
  const Value& surface = answer.at("tour").at("surface");
  EXPECT_LT(number(surface, "unknown"), 0.01 * number(surface, "known")) << to_json(surface);
  // Nor does a vehicle pass into the wings, which are solid.
  for (const Value& note : answer.at("notes").as_list())
    EXPECT_EQ(note.as_text().find("would pass"), std::string::npos) << note.as_text();
}

// A mast of 60 m beside the house: flights over it see the ground all the same.
TEST_F(Covering, AFirstFlightOverAMastSeesTheFloor) {
  write_file_atomically(folder_ / "house.obj", std::string(kHouseMesh) + R"(v 9 0 0
v 9.4 0 0
v 9.4 0 60
v 9 0 60
f 9 10 11 12
)");
  const auto first_flight = [&](const std::string& more) {
    const Value answer = of_house("--config scan/small " + more);
    return number(answer.at("tour").at("surface").at("true"), "first_flight_share");
  };
  EXPECT_GT(first_flight(""), 0.85);
  // From above the mast the floor is farther away than that.
  EXPECT_EQ(run("--set input=house.obj --set ground=true --data '" + folder_.string() +
                    "' --config scan/small --set range=60",
                "house.lua", "near"),
            2);
  EXPECT_THAT(error(), HasSubstr("saw no surface within range = 60 m"));
}

}  // namespace
}  // namespace lapwing
