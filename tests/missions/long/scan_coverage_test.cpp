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
  EXPECT_THAT(error(), HasSubstr("a crosshatch here has"));
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

}  // namespace
}  // namespace lapwing
