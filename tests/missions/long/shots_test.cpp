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

}  // namespace
}  // namespace lapwing
