// SPDX-License-Identifier: Apache-2.0
// The shipped films, flown a hundred times in wind with gusts.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class WindyFilms : public Filming {
 protected:
  Value simulated(const fs::path& plan, const std::string& controller) {
    const fs::path output = folder_ / "simulated.json";
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing simulate '" +
                             plan.string() + "' --runs 100 --wind 5,1.5 --tolerance 0.5 --json" +
                             " --controller " + controller + " > '" + output.string() + "'";
    EXPECT_LE(WEXITSTATUS(std::system(line.c_str())), 1);
    return from_json(read_file(output), "stdout");
  }
};

TEST_F(WindyFilms, AreFollowedAndFramed) {
  for (const char* film : kCameraFilms) {
    const Flown flown = fly(film);
    ASSERT_EQ(flown.status, 0) << film;
    for (const char* controller : {"thesis", "geometric", "tvlqr"}) {
      const Value runs = simulated(flown.folder / "plan.json", controller).at("simulations");
      std::printf("%s, %s: good %g, framed %g, worst %.3f m\n", film, controller,
                  runs.at("good_share").as_number(), runs.at("framed_share").as_number(),
                  runs.at("position_error").at("worst").as_number());
      EXPECT_EQ(runs.at("good_share").as_number(), 1) << film << ' ' << controller;
      EXPECT_LT(runs.at("position_error").at("worst").as_number(), 0.5) << film;
    }
  }
}

}  // namespace
}  // namespace lapwing
