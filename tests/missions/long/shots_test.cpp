// SPDX-License-Identifier: Apache-2.0
// Every designer's shot with hard keyframes: certified, at the smallest stretch that is.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

TEST_F(DesignersShots, AllThirtyTwo) {
  for (int number = 1; number <= 32; ++number) {
    SCOPED_TRACE(number);
    const Flown flown = fly_shot(number);
    expect_certified(flown);
    const Value& film = flown.result.at("film");
    const double stretch = film.at("stretch").as_number();
    if (stretch == 1) continue;
    const Flown less = fly_shot(number, "--set stretch=" + std::to_string(stretch / 1.011));
    EXPECT_EQ(less.status, 1) << "a smaller stretch is certified as well";
    std::printf("shot %02d: %s\n", number,
                flown.result.at("notes").as_list().at(0).as_text().c_str());
  }
}

TEST_F(DesignersShots, TooFastOnesAreStretchedOrExplained) {
  const Flown stretched = fly_shot(22);
  expect_certified(stretched);
  const double stretch = stretched.result.at("film").at("stretch").as_number();
  EXPECT_GT(stretch, 2.0);  // 20.7 m/s were asked for, 10 m/s are allowed
  EXPECT_LT(stretch, 2.5);
  const Flown fixed = fly_shot(22, "--set stretch=1");
  EXPECT_EQ(fixed.status, 1);
  const std::string note = fixed.result.at("notes").as_list().at(0).as_text();
  EXPECT_NE(note.find("speed_across of 20.7 m/s from keyframe 1 to 2 exceeds 10 m/s"),
            std::string::npos)
      << note;
  EXPECT_NE(note.find("certified from a stretch of 2."), std::string::npos) << note;
}

}  // namespace
}  // namespace lapwing
