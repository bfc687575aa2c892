// SPDX-License-Identifier: Apache-2.0
// Films of many keyframes whose times are free.
#include "tests/missions/flown_film.h"
#include "tests/missions/random_list.h"

namespace lapwing {
namespace {

class FreeTimes : public Filming {
 protected:
  Flown list(int count, int seed) {
    write_file_atomically(folder_ / "film.lua", random_list(count, seed));
    return fly((folder_ / "film.lua").string(), "", "out", 2);
  }
};

TEST_F(FreeTimes, FortyListsOfFiftyKeyframes) {
  for (int seed = 1; seed <= 40; ++seed) {
    const Flown flown = list(50, seed);
    EXPECT_EQ(flown.status, 0) << seed << to_json(flown.result);
    std::printf("seed %d: %.4g s of flight, solved in %.3g s\n", seed,
                flown.result.at("film").at("duration").as_number(),
                flown.result.at("seconds").at("solve").as_number());
  }
}

TEST_F(FreeTimes, TheCostIsLinearInTheNumberOfKeyframes) {
  for (const int count : {10, 20, 50, 100, 200}) {
    const Flown flown = list(count, 1);
    EXPECT_EQ(flown.status, 0) << count << to_json(flown.result);
    std::printf("%d keyframes: solved in %.3g s\n", count,
                flown.result.at("seconds").at("solve").as_number());
  }
}

}  // namespace
}  // namespace lapwing
