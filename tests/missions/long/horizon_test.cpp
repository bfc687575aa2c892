// SPDX-License-Identifier: Apache-2.0
// Long films in parts, and the shipped film of a live subject.
#include "tests/missions/flown_film.h"
#include "tests/missions/random_list.h"

namespace lapwing {
namespace {

class LongHorizons : public Filming {
 protected:
  Flown film(const std::string& text, const std::string& more, const char* name) {
    write_file_atomically(folder_ / "film.lua", text);
    return fly((folder_ / "film.lua").string(), more, name);
  }
  static double seconds(const Flown& flown) {
    return flown.result.at("seconds").at("total").as_number();
  }
};

// Walks of 5 and of 10 minutes: within 1 % of the whole, in a time that grows with the length.
TEST_F(LongHorizons, CostWithinOnePercentOfTheWhole) {
  for (const int seed : {1, 2, 3}) {
    double before = 0;
    for (const int count : {51, 101}) {
      const std::string text = long_walk(count, seed), step = "--set step=0.1 --set battery=700 ";
      const Flown whole = film(text, step, "whole");
      const Flown parts = film(text, step + "--set horizon=10", "parts");
      ASSERT_EQ(whole.status, 0) << seed;
      expect_certified(parts);
      std::printf("%d keyframes, seed %d: whole %.6g in %.2f s, parts of 10 s %.6g in %.2f s\n",
                  count, seed, cost(whole), seconds(whole), cost(parts), seconds(parts));
      EXPECT_LT(cost(parts), 1.01 * cost(whole)) << seed;
      if (before > 0) {
        EXPECT_LT(seconds(parts), 3.5 * before) << "it grows faster than the film";
      }
      before = seconds(parts);
    }
  }
}

TEST_F(LongHorizons, TheShippedRunnerStaysInTheImage) {
  const Flown flown = fly("live_runner.lua");
  expect_certified(flown);
  EXPECT_GT(framing(flown), 0.99);
  constexpr double kUpdates = 400;
  const double each = flown.result.at("seconds").at("solve").as_number() / kUpdates;
  std::printf("solving: %.1f ms an update on average, one every 100 ms\n", 1e3 * each);
  EXPECT_LT(each, 0.1);
}

}  // namespace
}  // namespace lapwing
