// SPDX-License-Identifier: Apache-2.0
// Light paintings that take minutes.
#include <gmock/gmock.h>

#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

class LongPainting : public Filming {
 protected:
  std::string script(const std::string& more) {
    const fs::path file = folder_ / "painting.lua";
    write_file_atomically(file,
                          "return require 'mission.light_painting'.text { name = 'painting', "
                          "text = 'HELLO', height = 2, speed = 0.2, " +
                              more + " }");
    return file.string();
  }
};

class SlowLongPainting : public LongPainting {};

TEST_F(SlowLongPainting, TheStepAdaptsAndTheReasonIsSaid) {
  const Flown flown = fly(script(""));
  expect_certified(flown);
  const double duration = read_plan(flown.folder / "plan.json").trajectory.duration();
  EXPECT_GT(duration, 150) << "too short to need longer steps";
  ASSERT_NE(flown.result.find("notes"), nullptr);
  EXPECT_THAT(flown.result.at("notes").as_list()[0].as_text(),
              HasSubstr("s apart, not 0.05 s: more than 3000 make a flight of"));
}

TEST_F(LongPainting, AStepThatIsTooShortNamesOneThatFits) {
  const std::string command = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" +
                              script("step = 0.02") + "' --out '" + (folder_ / "none").string() +
                              "' > /dev/null 2> '" + (folder_ / "stderr.txt").string() + "'";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
  EXPECT_THAT(read_file(folder_ / "stderr.txt"), HasSubstr("step: "));
  EXPECT_THAT(read_file(folder_ / "stderr.txt"), HasSubstr("leave step out, or set 0.0"));
}

}  // namespace
}  // namespace lapwing
