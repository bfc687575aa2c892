// SPDX-License-Identifier: Apache-2.0
// The shipped explorations as they are.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class ExploringExamples : public Filming, public ::testing::WithParamInterface<const char*> {};

TEST_P(ExploringExamples, AreCertifiedAsTheyAre) {
  const Flown flown = fly(std::string("../explore/") + GetParam());
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  const Plan plan = read_plan(flown.folder / "plan.json");
  for (const Check& check : verify(plan, flown.folder).failures()) ADD_FAILURE() << to_line(check);
}
INSTANTIATE_TEST_SUITE_P(Explore, ExploringExamples,
                         ::testing::Values("city.lua", "office.lua", "explore_then_scan.lua"));

}  // namespace
}  // namespace lapwing
