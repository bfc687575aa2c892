// SPDX-License-Identifier: Apache-2.0
// More thrust may not make a race slower.
#include <gmock/gmock.h>

#include "tests/missions/race_fixture.h"

namespace lapwing {
namespace {

TEST_F(Race, MoreThrustIsNotMuchSlower) {
  // At the whole thrust the controller follows only a flight of 6.5 s, and 4.05 s at 0.9.
  const std::string course =
      "vehicle = 'vehicles/racer', closed = true, floor = 0.5, gates = { { name = 'south', shape = "
      "'rectangle', position = {0, -12, 2}, normal_yaw_deg = 0, width = 3, height = 2 }, { name = "
      "'east', shape = 'hexagon', position = {12, 2, 4}, normal_yaw_deg = 120, side = 1.5 }, "
      "{ name = 'west', shape = 'ball', position = {-12, 4, 3}, radius = 0.5 } }, ";
  const Flown flown = race(course + "thrust = 1");
  expect_certified(flown);
  EXPECT_LT(time_of(flown), 4.3);
  ASSERT_NE(flown.result.find("notes"), nullptr) << to_json(flown.result);
  EXPECT_THAT(flown.result.at("notes").as_list().at(0).as_text(),
              testing::HasSubstr("leaves the rest to the controller"));
}

}  // namespace
}  // namespace lapwing
