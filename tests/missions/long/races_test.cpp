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

TEST_F(Race, SolversAgreeOnSevenGates) {
  const Flown ipopt = fly("../racing/seven_gates.lua", "--set solver=ipopt", "ipopt");
  const Flown iqp = fly("../racing/seven_gates.lua", "", "iqp");
  expect_flown_by_rotors(iqp, 7);
  EXPECT_NEAR(time_of(iqp), time_of(ipopt), 0.005 * time_of(ipopt));
  EXPECT_LT(solve_seconds(iqp), solve_seconds(ipopt));
  std::printf("seven gates: ipopt %.4g s of flight in %.3g s, iqp %.4g s in %.3g s\n",
              time_of(ipopt), solve_seconds(ipopt), time_of(iqp), solve_seconds(iqp));
}

// Nineteen balls of 0.3 m; flown by the controller of the vehicle file, with its lag and delay and
// an error of the mass, it passes all of them every time.
TEST_F(Race, SplitSIsPlannedAndFlown) {
  const Flown flown = fly("../racing/split_s.lua");
  expect_certified(flown);
  expect_flown_by_rotors(flown, 19);
  EXPECT_LE(time_of(flown), 18);
  std::printf("split S: %.4g s of flight in %.3g s\n", time_of(flown), solve_seconds(flown));
  const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing simulate '" +
                           (flown.folder / "plan.json").string() +
                           "' --runs 100 --mass-error 5 --json > '" +
                           (folder_ / "runs.json").string() + "'";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 0);
  const Value runs = from_json(read_file(folder_ / "runs.json"), "stdout").at("simulations");
  EXPECT_EQ(runs.at("good_share").as_number(), 1);
  std::printf("split S: through every gate in %g of 100 runs, worst %.3f m from the plan\n",
              100 * runs.at("good_share").as_number(),
              runs.at("position_error").at("worst").as_number());
}

TEST_F(Race, CostIsLinearInTheNumberOfGates) {
  for (const int count : {5, 10, 20, 40, 80}) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i)
      points.emplace_back(6.0 * i, 8 * std::sin(0.55 * i), 1.5 - 1.5 * std::cos(0.7 * i));
    const Flown flown = race(keyframes(points) +
                             "model = 'quadrotor_full', thrust = 0.9, solver = 'iqp', closed_loop "
                             "= 'reported', ");
    expect_flown_by_rotors(flown, count);
    std::printf("%d balls: %.4g s of flight in %.3g s\n", count, time_of(flown),
                solve_seconds(flown));
  }
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
