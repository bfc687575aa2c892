// SPDX-License-Identifier: Apache-2.0
// Run folders: what belongs to a run, and what is kept.
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/export/run_folder.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class RunSets : public testing::Test {
 protected:
  RunSets() : base_(fs::path(testing::TempDir()) / "lapwing_run_sets"), folder_(base_ / "shot") {
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  ~RunSets() override { fs::remove_all(base_); }
  static RunFiles files(const std::string& mission) {
    return {.plan = mission, .log = "warning: x\ninfo: mission " + mission + ", seed 1\n"};
  }
  fs::path base_, folder_;
};

TEST_F(RunSets, TellWhoseTheyAre) {
  EXPECT_EQ(mission_in(folder_), std::nullopt);
  write_run_folder(folder_, files("a, seed b"));
  EXPECT_EQ(mission_in(folder_), "a, seed b");
  write_file_atomically(folder_ / "run.log", "a log of something else\n");
  EXPECT_EQ(mission_in(folder_), std::nullopt);
}

// A folder from elsewhere may hold any list: nothing but a run's own files is touched.
TEST_F(RunSets, AListInAFolderTakesAwayOnlyWhatRunsWrite) {
  const fs::path orders = folder_ / ".lapwing-exchange" / ".orders";
  write_file_atomically(folder_ / "notes.txt", "mine");
  write_file_atomically(folder_ / "plan.json", "{}");
  for (const char* list :
       {"bogus notes.txt\n", "drop notes.txt\n", "drop plan.json\ndrop notes.txt\n"}) {
    write_file_atomically(orders, list);
    EXPECT_NE(complete_run_folder(folder_), "") << list;
    EXPECT_THROW(require_run_folder(folder_), InputError) << list;
    EXPECT_EQ(read_file(folder_ / "notes.txt"), "mine") << list;
    EXPECT_EQ(read_file(folder_ / "plan.json"), "{}") << list;
  }
  write_file_atomically(orders, "drop plan.json\ndrop obstacle_3.ply\n");
  EXPECT_EQ(complete_run_folder(folder_), "");
  EXPECT_FALSE(fs::exists(folder_ / "plan.json"));
}

TEST_F(RunSets, ForeignFilesOfTheSameNamesAreRefused) {
  require_run_folder(folder_);
  write_file_atomically(folder_ / "obstacle_course.ply", "mine");
  require_run_folder(folder_);
  write_file_atomically(folder_ / "map.ot", "mine");
  EXPECT_THROW(require_run_folder(folder_), InputError);
}

TEST_F(RunSets, RemoveWhatAnOlderRunHadAndNothingElse) {
  RunFiles first = files("a");
  first.map = "old";
  first.obstacles = {{"obstacle_1.ply", "old"}, {"obstacle_12.ot", "old"}, {"prior.ply", "old"}};
  write_run_folder(folder_, first);
  write_file_atomically(folder_ / "obstacle_course.ply", "mine");
  RunFiles second = files("b");
  second.obstacles = {{"obstacle_1.ply", "new"}};
  EXPECT_TRUE(write_run_folder(folder_, second).empty());
  EXPECT_EQ(read_file(folder_ / "obstacle_1.ply"), "new");
  EXPECT_EQ(read_file(folder_ / "obstacle_course.ply"), "mine");
  for (const char* gone : {"obstacle_12.ot", "prior.ply", "map.ot"})
    EXPECT_FALSE(fs::exists(folder_ / gone)) << gone;
}

TEST_F(RunSets, AreKeptUnderTheFirstFreeNumber) {
  EXPECT_TRUE(write_run_folder(folder_, files("a"), true).empty()) << "there was none";
  fs::create_directory(base_ / "shot.1");
  EXPECT_EQ(write_run_folder(folder_ / "", files("b"), true), base_ / "shot.2");
  EXPECT_EQ(mission_in(base_ / "shot.2"), "a");
  EXPECT_EQ(mission_in(folder_), "b");
  EXPECT_EQ(std::distance(fs::directory_iterator(base_), {}), 3);
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  EXPECT_THROW(write_run_folder(".", files("c"), true), InputError);
  fs::current_path(before);
  EXPECT_EQ(mission_in(folder_), "b");
}

}  // namespace
}  // namespace lapwing
