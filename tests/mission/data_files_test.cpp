// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/data_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class DataFilesTest : public ::testing::Test {
 protected:
  DataFilesTest() {
    root_ = fs::temp_directory_path() / ("lapwing_files_" + std::to_string(::getpid()));
    write_file_atomically(root_ / "data/shots/a.json", R"({"n": 1})");
    write_file_atomically(root_ / "data/b.json", R"({"n": 2})");
    write_file_atomically(root_ / "script/b.json", R"({"n": 3})");
    write_file_atomically(root_ / "secret.json", R"({"n": 4})");
    fs::create_symlink(root_ / "secret.json", root_ / "data/link.json");
    fs::create_directory_symlink(root_, root_ / "data/up");
  }
  ~DataFilesTest() override { fs::remove_all(root_); }

  std::string error(const std::string& name) {
    try {
      files_().find(name, "shots");
      return "found";
    } catch (const InputError& e) {
      return e.what();
    }
  }
  DataFiles files_() { return DataFiles({root_ / "script", root_ / "data", root_ / "absent"}); }
  fs::path root_;
};

TEST_F(DataFilesTest, FindsInOrder) {
  EXPECT_EQ(files_().read_json("b.json").at("n").as_integer(), 3);
  EXPECT_EQ(files_().read_json("shots/a.json").at("n").as_integer(), 1);
  EXPECT_EQ(files_().read_json("a.json", "shots").at("n").as_integer(), 1);
  EXPECT_EQ(files_().read_json((root_ / "data/b.json").string()).at("n").as_integer(), 2);
}

TEST_F(DataFilesTest, RefusesWhatLeadsOut) {
  EXPECT_NE(error("../secret.json").find("'..' is not allowed"), std::string::npos);
  EXPECT_NE(error("x/../../secret.json").find("'..' is not allowed"), std::string::npos);
  EXPECT_NE(error("link.json").find("leads out of"), std::string::npos);
  EXPECT_NE(error("up/secret.json").find("leads out of"), std::string::npos);
  EXPECT_NE(error((root_ / "secret.json").string()).find("not found in"), std::string::npos);
  EXPECT_NE(error("/etc/passwd").find("not found in"), std::string::npos);
  EXPECT_NE(error("/dev/zero").find("not found in"), std::string::npos);
  EXPECT_NE(error("shots").find("not a regular file"), std::string::npos);
  EXPECT_NE(error("").find("not a file name"), std::string::npos);
  EXPECT_NE(error(std::string("a\0b", 3)).find("not a file name"), std::string::npos);
}

TEST_F(DataFilesTest, SaysWhereItLooked) {
  const std::string message = error("missing.json");
  EXPECT_NE(message.find("'missing.json' not found in " + (root_ / "script").string() + ", " +
                         (root_ / "data").string()),
            std::string::npos)
      << message;
  EXPECT_NE(message.find("--data DIR"), std::string::npos);
}

TEST_F(DataFilesTest, AllowsWhatTheUserNamed) {
  DataFiles files = files_();
  files.allow(root_ / "secret.json");
  EXPECT_EQ(files.read_json((root_ / "secret.json").string()).at("n").as_integer(), 4);
  EXPECT_EQ(files.read_json((root_ / "script/../secret.json").string()).at("n").as_integer(), 4);
  EXPECT_THROW(files.find("../other.json"), InputError);
}

TEST_F(DataFilesTest, TruncatedTextNamesTheLine) {
  write_file_atomically(root_ / "data/cut.json", "{\n  \"a\": [1,\n");
  try {
    files_().read_json("cut.json");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("cut.json:3"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace lapwing
