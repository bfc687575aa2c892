// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/export/run_folder.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class RunFolder : public testing::Test {
 protected:
  RunFolder() : folder_(fs::path(testing::TempDir()) / "lapwing_run_folder") {
    fs::remove_all(folder_);
  }
  ~RunFolder() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(RunFolder, NamesAreLowerCaseWithUnderscores) {
  EXPECT_EQ(run_folder_name("castle flyover"), "castle_flyover");
  EXPECT_EQ(run_folder_name("Castle-Flyover 2.1"), "castle-flyover_2_1");
  EXPECT_EQ(run_folder_name("../../etc/passwd"), "______etc_passwd");
  EXPECT_EQ(run_folder_name("Z\xc3\xbcrich \xe6\x97\xa5"), "z_rich__");
  EXPECT_EQ(run_folder_name("a_b"), "a_b");
  EXPECT_EQ(run_folder("My Shot"), fs::path("out") / "my_shot");
  EXPECT_EQ(run_folder("x", "/tmp/elsewhere"), fs::path("/tmp/elsewhere/x"));
}

TEST_F(RunFolder, RefusesNamesThatNameNoFolder) {
  EXPECT_THROW(run_folder_name(""), InputError);
  EXPECT_THROW(run_folder_name(std::string(201, 'a')), InputError);
  EXPECT_NO_THROW(run_folder_name(std::string(200, 'a')));
}

TEST_F(RunFolder, WritesWhatIsGiven) {
  write_run_folder(folder_, {.plan = "{}", .trajectory = "t", .report = "<html>", .log = ""});
  EXPECT_EQ(read_file(folder_ / "plan.json"), "{}");
  EXPECT_EQ(read_file(folder_ / "trajectory.csv"), "t");
  EXPECT_EQ(read_file(folder_ / "report.html"), "<html>");
  EXPECT_EQ(read_file(folder_ / "run.log"), "");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 4);  // no temporaries
}

TEST_F(RunFolder, NeverMixesTwoRuns) {
  write_run_folder(folder_, {.plan = "old", .trajectory = "old", .report = "old", .log = "old"});
  write_run_folder(folder_, {.log = "new"});
  EXPECT_EQ(read_file(folder_ / "run.log"), "new");
  EXPECT_FALSE(fs::exists(folder_ / "plan.json"));
  EXPECT_FALSE(fs::exists(folder_ / "trajectory.csv"));
}

TEST_F(RunFolder, AFileInTheWayIsOneClearError) {
  fs::create_directories(folder_.parent_path());
  write_file_atomically(folder_, "a file");
  EXPECT_THROW(write_run_folder(folder_, {.plan = "{}"}), InputError);
  EXPECT_EQ(read_file(folder_), "a file");
}

}  // namespace
}  // namespace lapwing
