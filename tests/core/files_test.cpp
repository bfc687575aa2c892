// SPDX-License-Identifier: Apache-2.0
#include "framework/core/files.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "framework/core/error.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class FilesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("lapwing_files_" + std::to_string(::getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  // Names in the folder; a leftover temporary would show.
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& item : fs::directory_iterator(folder_)) {
      found.push_back(item.path().filename().string());
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  fs::path folder_;
};

std::string refusal(const fs::path& path, std::string_view contents) {
  try {
    write_file_atomically(path, contents);
  } catch (const InputError& error) {
    return error.what();
  }
  return "written";
}

// While alive, no file may grow beyond `bytes`: a full disk, as a test can have it.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

// While alive, a superuser is nobody, to whom permissions apply.
class Nobody {
 public:
  Nobody() { dropped_ = ::geteuid() == 0 && ::seteuid(65534) == 0; }
  ~Nobody() {
    if (dropped_ && ::seteuid(0) != 0) std::abort();
  }

 private:
  bool dropped_ = false;
};

// The first folder from the root down to `folder` that may not be entered; `folder` where all may.
fs::path first_barred(const fs::path& folder) {
  fs::path so_far;
  for (const fs::path& part : folder) {
    so_far /= part;
    if (::faccessat(AT_FDCWD, so_far.c_str(), X_OK, AT_EACCESS) != 0) return so_far;
  }
  return folder;
}

TEST_F(FilesTest, WritesReplacesAndReadsBack) {
  const fs::path path = folder_ / "a" / "b" / "plan.json";
  write_file_atomically(path, "one");
  const std::string zeros("two\0three", 9);
  write_file_atomically(path, zeros);
  EXPECT_EQ(read_file(path), zeros);
  write_file_atomically(path, "");
  EXPECT_EQ(read_file(path), "");
}

TEST_F(FilesTest, KeepsModeAndFollowsLinks) {
  write_file_atomically(folder_ / "file", "one");
  fs::permissions(folder_ / "file", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("file", folder_ / "link");
  write_file_atomically(folder_ / "link", "two");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(read_file(folder_ / "file"), "two");
  EXPECT_EQ(fs::status(folder_ / "file").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(FilesTest, AFullTargetKeepsTheOldFile) {
  const fs::path path = folder_ / "plan.json";
  write_file_atomically(path, "old");
  std::string message;
  {
    const FullDisk full(4096);
    message = refusal(path, std::string(100000, 'x'));
  }
  EXPECT_EQ(message, "cannot write '" + path.string() + "': File too large");
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(names(), std::vector<std::string>{"plan.json"});
}

TEST_F(FilesTest, AReadOnlyTargetIsNamed) {
  const fs::path path = folder_ / "plan.json";
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                               fs::perms::others_exec);
  std::string message;
  {
    const Nobody nobody;
    message = refusal(path, "new");
  }
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_EQ(message, "cannot write '" + path.string() + "': Permission denied");
  EXPECT_TRUE(names().empty());
}

// Known beforehand, and nothing is made on the way.
TEST_F(FilesTest, WhatCannotBeWrittenIsKnownBefore) {
  const auto refused = [&](const fs::path& path) {
    try {
      require_writable(path);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  write_file_atomically(folder_ / "file", "one");
  EXPECT_EQ(refused(folder_ / "file"), "");
  EXPECT_EQ(refused(folder_ / "a/b/c.json"), "");
  EXPECT_EQ(refused("out_of_nowhere.json"), "");
  EXPECT_NE(refused(folder_).find("it is a folder"), std::string::npos);
  EXPECT_EQ(refused(folder_ / "file/a/b.json"),
            "cannot write '" + (folder_ / "file/a/b.json").string() + "': '" +
                (folder_ / "file").string() + "' is not a folder");
  EXPECT_NE(refusal(folder_ / "file/a/b.json", "x").find("Not a directory"), std::string::npos);
  EXPECT_EQ(names(), std::vector<std::string>{"file"});
  fs::permissions(folder_, fs::perms::owner_write, fs::perm_options::remove);
  fs::permissions(folder_,
                  fs::perms::group_read | fs::perms::group_exec | fs::perms::others_read |
                      fs::perms::others_exec,
                  fs::perm_options::add);
  std::string message, barred;
  {
    const Nobody nobody;
    message = refused(folder_ / "a/b/c.json");
    barred = first_barred(folder_).string();  // the system's own folder may be closed to others
  }
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_EQ(message, "cannot write '" + (folder_ / "a/b/c.json").string() + "': folder '" + barred +
                         "': Permission denied");
}

// Of several folders above a file, the one that may not be entered is named.
TEST_F(FilesTest, AClosedFolderOnTheWayIsNamed) {
  const fs::path closed = folder_ / "closed", path = closed / "a" / "c.json";
  fs::create_directories(closed / "a");
  fs::permissions(closed, fs::perms::none);
  std::string message, barred;
  {
    const Nobody nobody;
    try {
      require_writable(path);
    } catch (const InputError& error) {
      message = error.what();
    }
    barred = first_barred(closed).string();
  }
  fs::permissions(closed, fs::perms::owner_all);
  EXPECT_EQ(message,
            "cannot write '" + path.string() + "': folder '" + barred + "': Permission denied");
}

TEST_F(FilesTest, RefusesWhatIsNoFile) {
  fs::create_directory(folder_ / "sub");
  EXPECT_NE(refusal(folder_ / "sub", "x").find("it is a folder"), std::string::npos);
  EXPECT_NE(refusal(folder_ / "sub" / "", "x").find("names no file"), std::string::npos);
  EXPECT_NE(refusal("", "x").find("names no file"), std::string::npos);
  EXPECT_NE(refusal("/dev/null", "x").find("not a regular file"), std::string::npos);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  write_file_atomically(folder_ / "file", "x");
  EXPECT_NE(refusal(folder_ / "file" / "below", "x").find("Not a directory"), std::string::npos);
}

TEST_F(FilesTest, APipeIsReadButNotWaitedForWithoutEnd) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string message;
  try {
    read_file(pipe);
  } catch (const InputError& error) {
    message = error.what();
  }
  EXPECT_EQ(message, "cannot read '" + pipe.string() + "': nobody has written into it for 5 s");
  std::thread writer([&] {
    std::FILE* file = std::fopen(pipe.c_str(), "w");
    std::fputs(std::string(100000, 'x').c_str(), file);
    std::fclose(file);
  });
  EXPECT_EQ(read_file(pipe).size(), 100000u);
  writer.join();
}

// A program that takes its time to write is not nobody.
TEST_F(FilesTest, AWriterThatPausesIsWaitedFor) {
  const fs::path pipe = folder_ / "slow";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] {
    std::FILE* file = std::fopen(pipe.c_str(), "w");
    std::this_thread::sleep_for(std::chrono::milliseconds(5600));
    std::fputs("late", file);
    std::fclose(file);
  });
  EXPECT_EQ(read_file(pipe), "late");
  writer.join();
  std::thread nothing([&] { std::fclose(std::fopen(pipe.c_str(), "w")); });
  EXPECT_EQ(read_file(pipe), "");
  nothing.join();
}

TEST_F(FilesTest, ReadersSeeOldOrNewNeverHalf) {
  const fs::path path = folder_ / "plan.json";
  const std::string a(1 << 16, 'a'), b(1 << 16, 'b');
  write_file_atomically(path, a);
  std::thread writer([&] {
    for (int i = 0; i < 30; ++i) write_file_atomically(path, i % 2 ? a : b);
  });
  bool whole = true;
  for (int i = 0; i < 200; ++i) {
    const std::string seen = read_file(path);
    whole = whole && (seen == a || seen == b);
  }
  writer.join();
  EXPECT_TRUE(whole);
}

TEST_F(FilesTest, ReadingNamesPathAndReason) {
  const auto reading = [](const fs::path& path, std::size_t limit = 100) -> std::string {
    try {
      return read_file(path, limit);
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(reading("/no/such"), "cannot read '/no/such': No such file or directory");
  EXPECT_EQ(reading(folder_), "cannot read '" + folder_.string() + "': it is a folder");
  EXPECT_EQ(reading("/dev/zero"), "cannot read '/dev/zero': it is larger than 100 bytes");
  write_file_atomically(folder_ / "file", std::string(100, 'x'));
  EXPECT_EQ(reading(folder_ / "file").size(), 100u);
  EXPECT_NE(reading(folder_ / "file", 99).find("larger than 99"), std::string::npos);
  // A large one takes no memory before it is refused.
  fs::resize_file(folder_ / "file", std::uintmax_t{1} << 40);
  EXPECT_EQ(reading(folder_ / "file", std::size_t{1} << 39),
            "cannot read '" + (folder_ / "file").string() +
                "': with 1099511627776 bytes it is larger than 549755813888 bytes");
}

}  // namespace
}  // namespace lapwing
