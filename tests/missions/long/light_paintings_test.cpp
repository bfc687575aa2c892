// SPDX-License-Identifier: Apache-2.0
// Every letter and digit of a published font, flown and photographed.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class WholeFont : public Filming {};

TEST_F(WholeFont, EveryLetterAndDigitOfHersheysFutural) {
  if (!std::getenv("LAPWING_DATA")) GTEST_SKIP() << "LAPWING_DATA is not set";
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
  double worst = 0, longest = 0;
  for (const char letter : letters) {
    write_file_atomically(folder_ / "letter.lua",
                          std::string("return require 'mission.light_painting'.text { name = "
                                      "'letter', height = 2, font = "
                                      "'strokes/hershey/futural.jhf', text = '") +
                              letter + "' }");
    const Flown flown = fly((folder_ / "letter.lua").string());
    EXPECT_EQ(flown.status, 0) << letter;
    const double error = flown.result.at("light_painting").at("mean_error").as_number();
    const double seconds = read_plan(flown.folder / "plan.json").trajectory.duration();
    EXPECT_LE(error, 0.02) << letter;
    EXPECT_LE(seconds, 30) << letter;
    worst = std::max(worst, error), longest = std::max(longest, seconds);
  }
  RecordProperty("worst_mean_error_m", std::to_string(worst));
  RecordProperty("longest_s", std::to_string(longest));
}

}  // namespace
}  // namespace lapwing
