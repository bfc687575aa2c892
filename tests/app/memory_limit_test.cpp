// Too little memory is said in words, whoever asked for it.
#include "framework/plugin/abi.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

TEST_F(CommandLine, TooLittleMemoryIsSaidSo) {
  if (std::string(LAPWING_ABI_SANITIZER) != "none")
    GTEST_SKIP() << "sanitizers reserve more address space than any limit gives";
  int refused = 0;
  for (int megabytes = 100; megabytes <= 300; megabytes += 20) {
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

}  // namespace
}  // namespace lapwing
