// SPDX-License-Identifier: Apache-2.0
// The figures of racing, each with its time of computing: alone on a machine.
#include "tests/missions/race_fixture.h"

namespace lapwing {
namespace {

TEST_F(Race, TheKnownSevenGatesInTheirTime) {
  if (!has_tracks()) GTEST_SKIP() << "LAPWING_DATA names no folder with tracks";
  const Flown flown = fly("../racing/seven_gates.lua", "--set input=tracks/seven_gates.yaml");
  expect_certified(flown);
  EXPECT_LE(time_of(flown), 7.6);
  EXPECT_LE(solve_seconds(flown), 60);
}

TEST_F(Race, SevenGatesAtTheLimitOfTheRotors) {
  const Flown flown = fly("../racing/seven_gates.lua");
  expect_flown_by_rotors(flown, 7);
}

TEST_F(Race, FiftyRandomKeyframesInASecond) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Flown flown = race(keyframes(random_keyframes(seed)) + kGentle);
    expect_within_limits(flown);
    EXPECT_LE(solve_seconds(flown), 1.0) << seed;
  }
}

}  // namespace
}  // namespace lapwing
