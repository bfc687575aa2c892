// SPDX-License-Identifier: Apache-2.0
// What studies print of names: nothing that a terminal would obey.
#include "tests/app/program_fixture.h"
#include "tests/missions/exploring_fixture.h"

namespace lapwing {
namespace {

using StudyNames = CommandLine;

TEST_F(StudyNames, EscapeSequencesAreShownAsText) {
  const std::string world = "ya\x1b[31mrd.obj";
  write(world, kYard);
  const std::vector<std::string> quick{"--world", world, "--mapping",  "resolution=0.5",
                                       "--steps", "2",   "--episodes", "1"};
  const auto with = [&](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), quick.begin(), quick.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const auto expect_shown = [](const Finished& finished) {
    EXPECT_EQ(finished.status, 0) << finished.err;
    const std::string all = finished.out + finished.err;
    EXPECT_EQ(all.find('\x1b'), all.npos) << all;
    EXPECT_NE(all.find("ya\\x1b[31mrd"), all.npos) << all;
  };
  expect_shown(
      run(with({"evaluate", "explore"}, {"--utility", "frontier", "-o", "fo\x1b[32mund"})));
  expect_shown(run(with({"train", "dataset"}, {"-o", "samples"})));
}

}  // namespace
}  // namespace lapwing
