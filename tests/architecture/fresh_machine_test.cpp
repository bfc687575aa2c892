// SPDX-License-Identifier: Apache-2.0
// tests/fresh_machine, without a machine: its limit, its ends, and what it takes from the READMEs.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "framework/core/files.h"
#include "tests/guide.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class FreshMachine : public testing::Test {
 protected:
  // A tree with run.sh, where a machine can always be made and `steps` are its steps.
  void SetUp() override {
    fs::create_directories(folder_ / "tests/fresh_machine");
    fs::create_directories(folder_ / "bin");
    fs::copy(fs::path(LAPWING_SOURCE_DIR) / "tests/fresh_machine/run.sh",
             folder_ / "tests/fresh_machine/run.sh");
    write("tests/fresh_machine/machine.sh", "why_not() { return 1; }\n");
    // Name spaces need root: here is what follows the options.
    write("bin/unshare",
          "#!/bin/sh\nwhile [ \"${1#-}\" != \"$1\" ]; do shift; done\nexec \"$@\"\n");
    ::chmod((folder_ / "bin/unshare").c_str(), 0755);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }
  // The exit status of run.sh, whose output goes through a pipe; what it printed is in log_.
  int run(const std::string& steps, const std::string& seconds) {
    write("tests/fresh_machine/steps.sh", steps);
    const std::string command = "cd '" + folder_.string() + "' && PATH=\"$PWD/bin:$PATH\" " +
                                "LAPWING_FRESH_FOLDER=\"$PWD\" LAPWING_FRESH_SECONDS=" + seconds +
                                " bash -o pipefail -c 'bash tests/fresh_machine/run.sh 2>&1 | cat' "
                                "> log.txt";
    const int status = std::system(command.c_str());
    log_ = read_file(folder_ / "log.txt");
    return WEXITSTATUS(status);
  }

  const fs::path folder_ =
      fs::temp_directory_path() / ("lapwing_fresh_" + std::to_string(::getpid()));
  std::string log_;
};

TEST_F(FreshMachine, EndsWithItsStepsThoughSomebodyReadsItsOutput) {
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(run("echo done >>\"$log\"\n", "300"), 0) << log_;
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(60));
  EXPECT_NE(log_.find("all steps pass"), std::string::npos) << log_;
  EXPECT_EQ(run("exit 3\n", "300"), 1) << log_;
  EXPECT_NE(log_.find("failed after"), std::string::npos) << log_;
}

TEST_F(FreshMachine, FailsBeyondItsLimit) {
  EXPECT_EQ(run("exec sleep 600\n", "1"), 1) << log_;
  EXPECT_NE(log_.find("its limit is 1 s"), std::string::npos) << log_;
  EXPECT_EQ(run("true\n", "soon"), 2) << log_;
  const std::string script = read_file(folder_ / "tests/fresh_machine/run.sh");
  EXPECT_NE(script.find("LAPWING_FRESH_SECONDS:-1200}"), std::string::npos) << "20 minutes";
}

// What commands_of of machine.sh makes of a section.
std::string commands_of(const std::string& readme, const std::string& heading,
                        const fs::path& out) {
  const std::string root = LAPWING_SOURCE_DIR;
  const std::string command = "bash -c '. \"" + root +
                              "/tests/fresh_machine/machine.sh\"; commands_of \"$0\" \"$1\"' '" +
                              root + "/" + readme + "' '" + heading + "' > '" + out.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return read_file(out);
}

TEST_F(FreshMachine, TypesWhatTheReadmesSay) {
  const std::string typed =
      commands_of("plugins/README.md", "## A first cost term", folder_ / "typed");
  std::size_t at = 0;
  for (const Snippet& snippet :
       snippets_of(fs::path(LAPWING_SOURCE_DIR) / "plugins/README.md", "## A first cost term")) {
    at = typed.find(snippet.text, at);
    ASSERT_NE(at, std::string::npos) << snippet.text;
  }
  EXPECT_NE(typed.find("cat >low.lua <<'END_OF_SNIPPET'\n-- low.lua\n"), std::string::npos);
  EXPECT_NE(
      commands_of("README.md", "## Two commands", folder_ / "typed").find("\nbash scripts/test.sh"),
      std::string::npos);
  EXPECT_NE(commands_of("README.md", "## `lapwing` as a command", folder_ / "typed")
                .find("cmake --install build/release"),
            std::string::npos);
  // steps.sh has no copy of them.
  const std::string steps =
      read_file(fs::path(LAPWING_SOURCE_DIR) / "tests/fresh_machine/steps.sh");
  for (const char* copy : {"keep_low.cpp", "film.shot", "scripts/test.sh", "lapwing new plugin"})
    EXPECT_EQ(steps.find(copy), std::string::npos) << copy;
}

}  // namespace
}  // namespace lapwing
