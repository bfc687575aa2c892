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

// Balls of 0.3 m, the seven places of a known course passed almost three times.
TEST_F(Race, NineteenBallsByIqp) {
  const double places[7][3] = {{-1.1, -1.6, 3.6}, {9.2, 6.6, 1.0},   {9.2, -4.0, 1.2},
                               {-4.5, -6.0, 3.5}, {-4.5, -6.0, 0.8}, {4.75, -0.9, 1.2},
                               {-2.8, 6.8, 1.2}};
  std::string gates;
  for (int i = 0; i < 19; ++i) {
    char line[96];
    const double* p = places[i % 7];
    std::snprintf(line, sizeof line, "{shape = 'ball', radius = 0.3, position = {%g, %g, %g}}, ",
                  p[0], p[1], p[2]);
    gates += line;
  }
  const Flown flown = race(
      "vehicle = 'vehicles/racer', model = 'quadrotor_full', thrust = 1, solver = 'iqp', step = "
      "0.05, closed_loop = 'reported', start = {-5, 4.5, 1.2}, finish = {4.75, -0.9, 1.2}, gates = "
      "{ " +
      gates + "}, ");
  expect_flown_by_rotors(flown, 19);
  EXPECT_LE(time_of(flown), 17.9);
  std::printf("nineteen balls: %.4g s of flight in %.3g s\n", time_of(flown), solve_seconds(flown));
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
