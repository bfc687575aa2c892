// SPDX-License-Identifier: Apache-2.0
#include "framework/core/folders.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class Folders : public ::testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::temp_directory_path() / ("lapwing_folders_" + std::to_string(::getpid()));
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  void TearDown() override { fs::remove_all(base_); }
  std::size_t entries(const fs::path& folder) const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }
  fs::path base_;
};

TEST_F(Folders, AppearWholeAndReplaceTheirOlderSelves) {
  const fs::path target = base_ / "a" / "model";
  write_folder_atomically(target, {{"x.txt", "1"}, {"y.txt", "2"}});
  EXPECT_EQ(read_file(target / "x.txt"), "1");
  write_folder_atomically(target / "", {{"x.txt", "3"}, {"y.txt", "4"}});
  EXPECT_EQ(read_file(target / "x.txt"), "3");
  EXPECT_EQ(entries(target), 2u);
  EXPECT_EQ(entries(base_ / "a"), 1u);  // nothing temporary is left
}

TEST_F(Folders, WhatIsThereAlreadyIsNotLost) {
  fs::create_directories(base_ / "photos");
  write_file_atomically(base_ / "photos" / "mine.jpg", "!");
  EXPECT_THROW(write_folder_atomically(base_ / "photos", {{"x.txt", "1"}}), InputError);
  EXPECT_EQ(read_file(base_ / "photos" / "mine.jpg"), "!");
  write_file_atomically(base_ / "file", "!");
  EXPECT_THROW(write_folder_atomically(base_ / "file", {{"x.txt", "1"}}), InputError);
  EXPECT_THROW(write_folder_atomically("", {{"x.txt", "1"}}), InputError);
  EXPECT_THROW(write_folder_atomically(base_ / "new", {{"../x.txt", "1"}}), Error);
  EXPECT_FALSE(fs::exists(base_ / "new"));
  EXPECT_EQ(entries(base_), 2u);
}

}  // namespace
}  // namespace lapwing
