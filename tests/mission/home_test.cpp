// SPDX-License-Identifier: Apache-2.0
// The take-off place of a mission: stated once for every kind, kept in its plan.
#include <gmock/gmock.h>

#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

class Homes : public MissionTest {
 protected:
  std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
      const auto mission = load(text);
      mission->configure({}, overrides);
      mission->judge();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(Homes, PlansOfEveryKindHaveTheirs) {
  const std::string home =
      "home = { position = {1, 2, -0.5}, max_height = '400 ft', max_distance = 300, "
      "rally_points = { { position = {20, 0, 15} } } }";
  for (const std::string& text :
       {kFilm + home + " }",
        "return require 'mission.race'.course { start = {0, 0, 2}, gates = { { shape = 'ball', "
        "radius = 1, position = {8, 4, 2} } }, closed_loop = 'reported', " +
            home + " }",
        "return require 'mission.light_painting'.text { text = 'i', " + home + " }"}) {
    const auto mission = load(text);
    mission->configure({}, {});
    const Plan plan = mission->plan().plan;
    ASSERT_TRUE(plan.home) << text;
    EXPECT_EQ(plan.home->position, Eigen::Vector3d(1, 2, -0.5));
    EXPECT_NEAR(*plan.home->max_height, 121.92, 1e-9);
    EXPECT_EQ(plan.home->max_distance, 300);
    ASSERT_EQ(plan.home->rally_points.size(), 1u);
    EXPECT_EQ(plan.home->rally_points[0], Eigen::Vector3d(20, 0, 15));
  }
  const auto mission = load(std::string(kFilm) + "}");
  mission->configure({}, {});
  EXPECT_FALSE(mission->plan().plan.home);
}

TEST_F(Homes, BadOnesAreRefusedByFileAndKeyBeforePlanning) {
  const auto with = [](const std::string& home) {
    return std::string(kFilm) + "home = {" + home + "} }";
  };
  EXPECT_THAT(refusal(with("max_height = 120")),
              HasSubstr("shot.lua:8: home.position: missing; expected the take-off place"));
  EXPECT_THAT(refusal(with("rally_points = { { position = {1, 2, 3} } }")),
              HasSubstr("home.position: missing"));
  EXPECT_THAT(refusal(with("position = {1, 2}")), HasSubstr("home.position"));
  EXPECT_THAT(refusal(with("position = {1, 2, 3}, max_height = 0")), HasSubstr("home.max_height"));
  EXPECT_THAT(refusal(with("position = {1, 2, 3}, rally_points = { {1, 2, 3} }")),
              HasSubstr("home.rally_points"));
  EXPECT_THAT(refusal(with("position = {1, 2, 3}, max_hight = 120")), HasSubstr("max_height"));
}

TEST_F(Homes, KeyframesBeyondTheLimitsAreRefusedAtTheirLine) {
  const auto film = [](const std::string& home) {
    return "local film = require 'mission.film'\nreturn film.shot {\n  keyframes = {\n"
           "    { position = {0, 0, 2} },\n    { position = {30, 40, 20} } },\n" +
           ("  home = {" + home + "} }");
  };
  EXPECT_EQ(refusal(film("position = {0, 0, 0}, max_height = 20, max_distance = 50")), "");
  EXPECT_THAT(refusal(film("position = {0, 0, -3}, max_height = 20")),
              HasSubstr("keyframes[2].position: 23 m above home, beyond home.max_height = 20 m"));
  EXPECT_THAT(refusal(film("position = {0, 0, 0}, max_distance = '40 m'")),
              HasSubstr("keyframes[2].position: 50 m from home, beyond home.max_distance = 40 m"));
}

// What fails is told as it is, and not as a flight of another vehicle would have it.
TEST_F(Homes, AFilmThatBreaksALimitSaysWhich) {
  const auto mission =
      load(kFilm + std::string("home = { position = {0, 0, 0}, max_height = 3.6 } }"));
  mission->configure({}, {});
  const MissionResult result = mission->plan();
  std::string said;
  for (const std::string& note : result.notes) said += note + "\n";
  EXPECT_THAT(said, HasSubstr("height_above_home"));
  EXPECT_THAT(said, testing::Not(HasSubstr("without the limits of the vehicle")));
}

}  // namespace
}  // namespace lapwing
