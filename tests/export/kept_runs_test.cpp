// SPDX-License-Identifier: Apache-2.0
// A run that keeps the older one (`--keep`), killed at every system call that it makes.
#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "framework/core/error.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/export/run_folder.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class KeptRuns : public testing::Test {
 protected:
  KeptRuns()
      : base_(fs::path(testing::TempDir()) / ("lapwing_kept_runs_" + std::to_string(::getpid()))),
        folder_(base_ / "shot") {
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  ~KeptRuns() override { fs::remove_all(base_); }

  static RunFiles files(const std::string& mission) {
    return {.plan = mission, .log = "info: mission " + mission + ", seed 1\n"};
  }
  // The mission whose run a folder holds; "none", or "several" where files of two are mixed.
  static std::string run_in(const fs::path& folder) {
    if (!fs::exists(folder / "plan.json") || !fs::exists(folder / "run.log")) return "none";
    const std::string plan = read_file(folder / "plan.json");
    return mission_in(folder) == plan ? plan : "several";
  }

  // Writes a run over the older one in a process that is killed at its system call number `at`,
  // entries and exits counted. Whether it came to its end before.
  bool write_until(int at) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
      ::raise(SIGSTOP);
      write_run_folder(folder_, files("new"), true);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    if (!WIFSTOPPED(status)) return true;
    for (int call = 0; call < at; ++call) {
      ::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
      ::waitpid(child, &status, 0);
      if (WIFEXITED(status)) return true;
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    return false;
  }

  fs::path base_, folder_;
};

TEST_F(KeptRuns, AKillAtAnyStepLeavesAWholeRunUnderTheName) {
  bool ended = false, old_seen = false, new_seen = false;
  int step = 1;
  for (; !ended; ++step) {
    ASSERT_LT(step, 5000);
    fs::remove_all(base_);
    write_run_folder(folder_, files("old"));
    ended = write_until(step);
    EXPECT_EQ(complete_run_folder(folder_), "") << step;
    const std::string found = run_in(folder_);
    EXPECT_TRUE(found == "old" || found == "new") << "step " << step << ": " << found;
    if (found == "new") {
      EXPECT_EQ(run_in(base_ / "shot.1"), "old") << step;
    }
    old_seen = old_seen || found == "old";
    new_seen = new_seen || (found == "new" && !ended);
    write_run_folder(folder_, files("next"), true);
    EXPECT_EQ(run_in(folder_), "next") << "step " << step;
  }
  EXPECT_GT(step, 20) << "no step was seen: nothing traces here";
  EXPECT_TRUE(old_seen && new_seen);
}

// The older folder goes on under another name; the claim stays with the name.
TEST_F(KeptRuns, TheClaimStaysWithTheName) {
  write_run_folder(folder_, files("old"));
  {
    const FolderClaim claim(folder_);
    EXPECT_EQ(write_run_folder(folder_, files("new"), true), base_ / "shot.1");
    EXPECT_THROW(FolderClaim second(folder_), InputError);
    EXPECT_THROW(FolderClaim third(base_ / "." / "shot" / ""), InputError) << "another way there";
    fs::remove_all(folder_);
    EXPECT_THROW(FolderClaim fourth(folder_), InputError) << "the folder is another one now";
  }
  const FolderClaim again(folder_);
}

TEST_F(KeptRuns, NoLockIsLeftBesideTheFolder) {
  {
    const FolderClaim claim(folder_);
    EXPECT_TRUE(fs::exists(base_ / ".shot.lock"));
    write_run_folder(folder_, files("a"));
  }
  EXPECT_FALSE(fs::exists(base_ / ".shot.lock"));
  write_file_atomically(base_ / ".shot.lock", "");  // of a process that was killed
  { const FolderClaim claim(folder_); }
  EXPECT_FALSE(fs::exists(base_ / ".shot.lock"));
}

}  // namespace
}  // namespace lapwing
