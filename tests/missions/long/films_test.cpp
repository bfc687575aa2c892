// SPDX-License-Identifier: Apache-2.0
// Every shipped film with every solver that it should work with.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

TEST_F(Filming, IpoptAgreesWithinOnePercent) {
  for (const char* film : kCameraFilms) {
    SCOPED_TRACE(film);
    const Flown iqp = fly(film, "--config solvers/iqp", "iqp");
    const Flown ipopt = fly(film, "--config solvers/ipopt", "ipopt");
    expect_certified(iqp);
    expect_certified(ipopt);
    EXPECT_GE(framing(ipopt), 0.99);
    EXPECT_NEAR(cost(ipopt), cost(iqp), 0.01 * cost(iqp));
    std::printf("%s: iqp %.6g, ipopt %.6g\n", film, cost(iqp), cost(ipopt));
  }
}

TEST_F(Filming, NloptAgreesWithinFivePercent) {
  for (const char* film : {"hello.lua", "orbit.lua", "castle_flyover.lua"}) {
    SCOPED_TRACE(film);
    const Flown iqp = fly(film, "--config solvers/iqp", "iqp");
    const Flown nlopt = fly(film, "--config solvers/nlopt", "nlopt");
    expect_certified(nlopt);
    EXPECT_LE(cost(nlopt), 1.05 * cost(iqp));
    const double seconds = nlopt.result.at("seconds").at("solve").as_number();
    EXPECT_LE(seconds, 60);
    std::printf("%s: iqp %.6g, nlopt %.6g in %.1f s\n", film, cost(iqp), cost(nlopt), seconds);
  }
}

TEST_F(Filming, NineteenOfTwentyForestsAreCrossed) {
  int certified = 0;
  for (int seed = 1; seed <= 20; ++seed)
    certified +=
        fly("through_the_forest.lua", "--set solver.iterations=20 --seed " + std::to_string(seed))
            .status == 0;
  EXPECT_GE(certified, 19);
}

}  // namespace
}  // namespace lapwing
