// SPDX-License-Identifier: Apache-2.0
// The thrust that a race names where the controller cannot follow is one that it can.
#include "tests/missions/race_advice.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

TEST_F(RaceAdvice, TheThrustThatIsNamedIsFollowed) {
  const Flown flown = race(turns(""));
  ASSERT_EQ(flown.status, 1) << to_json(flown.result);
  const std::vector<std::string> said = notes(flown);
  ASSERT_FALSE(said.empty());
  EXPECT_THAT(said[0], HasSubstr("the closed loop tracks this course at thrust = 0."));
  EXPECT_THAT(said[0], HasSubstr(" s instead of "));
  const Flown followed = race(turns(""), settings(said[0]));
  expect_certified(followed);
  EXPECT_GT(time_of(followed), time_of(flown));
}

}  // namespace
}  // namespace lapwing
