// SPDX-License-Identifier: Apache-2.0
// Too little memory is said in words, whoever asked for it.
#include "framework/plugin/abi.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

TEST_F(CommandLine, TooLittleMemoryIsSaidSo) {
  if (std::string(LAPWING_ABI_SANITIZER) != "none")
    GTEST_SKIP() << "sanitizers reserve more address space than any limit gives";
  int refused = 0;
  // With less the system's loader refuses, before the program begins.
  for (int megabytes = 120; megabytes <= 300; megabytes += 20) {
    write("limited.sh",
          "cd '" + folder_.string() + "' && ulimit -v " + std::to_string(megabytes * 1024) +
              " && '" LAPWING_BUILD_DIR "/bin/lapwing' scene view street -o page.html 2> err.txt");
    const int status =
        WEXITSTATUS(std::system(("bash '" + (folder_ / "limited.sh").string() + "'").c_str()));
    if (status == 0) continue;
    const std::string said = read_file(folder_ / "err.txt");
    EXPECT_EQ(status, 3) << megabytes << " MB: " << said;
    EXPECT_NE(said.find("ulimit -v"), std::string::npos) << megabytes << " MB: " << said;
    ++refused;
  }
  EXPECT_GT(refused, 0);
}

// Ipopt goes on after its linear solver ran out of memory, as if the problem were at fault.
TEST_F(CommandLine, ASolverWithoutMemoryIsNoBadFlight) {
  if (std::string(LAPWING_ABI_SANITIZER) != "none")
    GTEST_SKIP() << "sanitizers reserve more address space than any limit gives";
  write("course.lua",
        "return require 'mission.race'.course { start = {-5, 0, 2}, finish = {12, 6, 2}, "
        "refinements = 0, closed_loop = 'reported', solver = 'ipopt', "
        "gates = { { shape = 'ball', position = {0, 0, "
        "2}, radius = 1 }, { shape = 'ball', position = {8, 5, 3}, radius = 1 } } }");
  int refused = 0;
  for (int megabytes = 122; megabytes <= 162; megabytes += 4) {
    write("limited.sh",
          "cd '" + folder_.string() + "' && ulimit -v " + std::to_string(megabytes * 1024) +
              " && '" LAPWING_BUILD_DIR
              "/bin/lapwing' run course.lua --threads 1 --quiet 2> err.txt > out.txt");
    const int status =
        WEXITSTATUS(std::system(("bash '" + (folder_ / "limited.sh").string() + "'").c_str()));
    if (status == 0) continue;
    const std::string said = read_file(folder_ / "err.txt");
    EXPECT_EQ(status, 3) << megabytes << " MB: " << said << read_file(folder_ / "out.txt");
    EXPECT_NE(said.find("ulimit -v"), std::string::npos) << megabytes << " MB: " << said;
    ++refused;
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace lapwing
