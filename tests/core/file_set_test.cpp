// SPDX-License-Identifier: Apache-2.0
#include "framework/core/file_set.h"

#include <gmock/gmock.h>

#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sched.h>
#include <csignal>
#include <random>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/temporary_names.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class FileSets : public testing::Test {
 protected:
  void SetUp() override {
    base_ =
        fs::temp_directory_path() / ("lapwing_sets_" + std::to_string(::getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  void TearDown() override { fs::remove_all(base_); }
  fs::path base_;
};

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> found;
  for (const auto& item : fs::directory_iterator(folder))
    found.push_back(item.path().filename().string());
  std::sort(found.begin(), found.end());
  return found;
}

std::string refusal_of(const fs::path& folder, const FileSet& set) {
  try {
    write_files_together(folder, set);
  } catch (const InputError& error) {
    return error.what();
  }
  return "written";
}

// All names that these tests give to files of their sets.
bool is_of_a_set(const std::string& name) {
  return name == "a.txt" || name == "b.txt" || name == "c.txt" || name == "old.txt";
}

// Three files that say which version they are of.
FileSet version(int number, std::size_t size) {
  const std::string text = std::to_string(number) + "\n" + std::string(size, 'x');
  return {{{"a.txt", text}, {"b.txt", text}, {"c.txt", text}}};
}

// The one version that all three files are of; -1 where they are of several or not whole.
int version_in(const fs::path& folder, std::size_t size) {
  int found = -1;
  for (const char* name : {"a.txt", "b.txt", "c.txt"}) {
    const std::string text = read_file(folder / name);
    const int number = std::atoi(text.c_str());
    if (text != version(number, size).files[0].second || (found >= 0 && number != found)) return -1;
    found = number;
  }
  return found;
}

// What `work` returns, asked in a process of its own.
template <class Work>
int in_child(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(FileSets, ReplaceWhatIsTheirsAndNothingElse) {
  const fs::path folder = base_ / "new" / "run";
  write_files_together(folder, {{{"a.txt", "1"}, {"b.txt", "1"}}});
  write_file_atomically(folder / "notes.txt", "mine");
  fs::permissions(folder / "a.txt", fs::perms::owner_read | fs::perms::owner_write);
  write_files_together(folder, {{{"a.txt", "2"}, {"c.txt", "2"}}, {"a.txt", "b.txt", "d.txt"}});
  EXPECT_EQ(names_in(folder), (std::vector<std::string>{"a.txt", "c.txt", "notes.txt"}));
  EXPECT_EQ(read_file(folder / "a.txt"), "2");
  EXPECT_EQ(read_file(folder / "notes.txt"), "mine");
  EXPECT_EQ(fs::status(folder / "a.txt").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(FileSets, AFolderInTheWayIsKnownBeforeAnythingIsChanged) {
  write_files_together(base_, version(1, 10));
  fs::remove(base_ / "c.txt");
  fs::create_directory(base_ / "c.txt");
  EXPECT_EQ(refusal_of(base_, version(2, 10)),
            "cannot write '" + (base_ / "c.txt").string() + "': it is a folder");
  EXPECT_EQ(read_file(base_ / "a.txt"), version(1, 10).files[0].second);
  EXPECT_EQ(names_in(base_), (std::vector<std::string>{"a.txt", "b.txt", "c.txt"}));
}

TEST_F(FileSets, AFullDiskLeavesTheOldSetWhole) {
  write_files_together(base_, version(1, 1000));
  FileSet next = version(2, 1000);
  next.files[2].second = std::string(100000, 'y');
  const int status = in_child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    return refusal_of(base_, next) ==
                   "cannot write '" + (base_ / "c.txt").string() + "': File too large"
               ? 0
               : 1;
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(version_in(base_, 1000), 1);
  EXPECT_EQ(names_in(base_), (std::vector<std::string>{"a.txt", "b.txt", "c.txt"}));
}

// A file system of 256 kB that holds 192 kB already: a second set of that size does not fit.
TEST_F(FileSets, ATrulyFullFileSystemLeavesTheOldSetWhole) {
  constexpr std::size_t kSize = 60000;
  constexpr int kNoMount = 77;
  const int status = in_child([&] {
    if (::unshare(CLONE_NEWNS) != 0 ||
        ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("none", base_.c_str(), "tmpfs", 0, "size=256k") != 0)
      return kNoMount;
    write_files_together(base_, version(1, kSize));
    const std::string message = refusal_of(base_, version(2, kSize));
    if (message.find("No space left on device") == std::string::npos) return 1;
    if (version_in(base_, kSize) != 1) return 2;
    if (names_in(base_) != std::vector<std::string>{"a.txt", "b.txt", "c.txt"}) return 3;
    write_files_together(base_, version(3, 100));  // what fits is written
    return version_in(base_, 100) == 3 ? 0 : 4;
  });
  if (status == kNoMount) GTEST_SKIP() << "no file system can be mounted here";
  EXPECT_EQ(status, 0);
}

// Killed at random moments, what is there is of one version, and the next writer clears up.
TEST_F(FileSets, AreOfOneVersionAfterAnyKill) {
  constexpr std::size_t kSize = 2000;
  if (fs::is_directory("/dev/shm")) {  // in memory many versions are written between two kills
    fs::remove_all(base_);
    base_ = fs::path("/dev/shm") / base_.filename();
  }
  write_files_together(base_, version(0, kSize));
  std::mt19937 random(7);
  int last = 0;
  for (int kill = 0; kill < 60; ++kill) {
    const pid_t child = ::fork();
    if (child == 0)
      for (int k = last + 1;; ++k) write_files_together(base_, version(k, kSize));
    ::usleep(500 + random() % 20000);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    finish_exchange(base_, is_of_a_set);
    const int found = version_in(base_, kSize);
    ASSERT_GE(found, last) << "killed the " << kill << "th time";
    last = found;
  }
  EXPECT_GT(last, 0);
  // A process looks into a folder once: a new one clears what all of these left.
  EXPECT_EQ(in_child([&] { return write_files_together(base_, version(last, kSize)), 0; }), 0);
  EXPECT_EQ(names_in(base_), (std::vector<std::string>{"a.txt", "b.txt", "c.txt"}));
}

// Each place at which the last step can be ended.
TEST_F(FileSets, AChangeThatWasDecidedIsCompleted) {
  for (int moved = 0; moved <= 3; ++moved) {
    const fs::path folder = base_ / std::to_string(moved), ready = folder / ".lapwing-exchange";
    write_files_together(folder, version(1, 10));
    write_file_atomically(folder / "old.txt", "1");
    for (const auto& [name, contents] : version(2, 10).files)
      write_file_atomically(ready / name, contents);
    write_file_atomically(ready / ".orders", "drop old.txt\nput a.txt\nput b.txt\nput c.txt\n");
    const char* names[] = {"a.txt", "b.txt", "c.txt"};
    if (moved > 0) fs::remove(folder / "old.txt");
    for (int k = 0; k < moved; ++k) fs::rename(ready / names[k], folder / names[k]);
    finish_exchange(folder, is_of_a_set);
    EXPECT_EQ(version_in(folder, 10), 2) << moved;
    EXPECT_EQ(names_in(folder), (std::vector<std::string>{"a.txt", "b.txt", "c.txt"})) << moved;
  }
}

// None of a list is done where one line of it is not a writer's.
TEST_F(FileSets, AListThatNoWriterWroteIsRefusedAsAWhole) {
  const fs::path folder = base_ / "run", orders = folder / ".lapwing-exchange" / ".orders";
  write_file_atomically(base_ / "precious", "!");
  write_file_atomically(folder / "notes.txt", "!");
  write_file_atomically(folder / "a.txt", "1");
  fs::create_directory(folder / "b.txt");
  for (const char* line :
       {"drop ../precious", "bogus a.txt", "bogus notes.txt", "drop notes.txt", "put notes.txt",
        "drop", "drop ", "drop .", "drop ..", "drop .hidden", "drop b.txt", "rubbish"}) {
    write_file_atomically(orders, std::string("drop a.txt\n") + line + "\n");
    EXPECT_THROW(finish_exchange(folder, is_of_a_set), InputError) << line;
    EXPECT_NE(finish_exchange_to_read(folder, is_of_a_set), "") << line;
    EXPECT_TRUE(fs::exists(base_ / "precious")) << line;
    EXPECT_EQ(names_in(folder),
              (std::vector<std::string>{".lapwing-exchange", "a.txt", "b.txt", "notes.txt"}))
        << line;
  }
  fs::remove(orders);
  fs::create_symlink("/dev/zero", orders);
  EXPECT_THROW(finish_exchange(folder, is_of_a_set), InputError);
}

TEST_F(FileSets, WhoReadsCompletesNothingOfALiveWriter) {
  write_file_atomically(base_ / "a.txt", "1");
  write_file_atomically(base_ / ".lapwing-exchange" / "a.txt", "2");
  write_file_atomically(base_ / ".lapwing-exchange" / ".orders", "put a.txt\n");
  {
    const FolderClaim writer(base_);
    EXPECT_THAT(finish_exchange_to_read(base_, is_of_a_set),
                testing::HasSubstr("another process is writing"));
    EXPECT_EQ(read_file(base_ / "a.txt"), "1");
  }
  EXPECT_EQ(finish_exchange_to_read(base_, is_of_a_set), "");
  EXPECT_EQ(read_file(base_ / "a.txt"), "2");
  EXPECT_EQ(names_in(base_), std::vector<std::string>{"a.txt"});
}

TEST_F(FileSets, TemporariesOfTheDeadAreClearedThoseOfTheLivingNot) {
  // In a folder that this process has not looked into yet.
  const fs::path folder = base_ / "folder";
  const auto leave_one = [&] { fs::create_directories(folder / temporary_name("set")); };
  EXPECT_EQ(in_child([&] { return leave_one(), 0; }), 0);  // this child is dead now
  leave_one();                                             // this process lives
  // Another process that once had the number of this one.
  std::string former = temporary_name("plan.json");
  const std::size_t count = former.rfind('-'), start = former.rfind('-', count - 1);
  former.replace(start + 1, count - start - 1, "1");
  write_file_atomically(folder / "x", "");  // looks: from here on this process clears no more
  write_file_atomically(folder / former, "");
  write_file_atomically(folder / ".tmp-mine", "not of this pattern");
  EXPECT_EQ(names_in(folder).size(), 4u);
  EXPECT_EQ(in_child([&] { return clear_dead_temporaries(folder), 0; }), 0);
  EXPECT_FALSE(fs::exists(folder / former));
  EXPECT_EQ(names_in(folder).size(), 3u) << "that of the living, and two that are none";
}

TEST_F(FileSets, AClaimedFolderIsRefusedToOthersAndNotLeftEmpty) {
  const fs::path folder = base_ / "out" / "run";
  {
    const FolderClaim claim(folder);
    EXPECT_TRUE(fs::is_directory(folder));
    EXPECT_EQ(in_child([&] {
                try {
                  const FolderClaim second(folder);
                } catch (const InputError& error) {
                  const std::string message = error.what();
                  return message.find("another process is writing") != std::string::npos ? 0 : 1;
                }
                return 2;
              }),
              0);
    EXPECT_TRUE(fs::is_directory(folder));
  }
  EXPECT_FALSE(fs::exists(base_ / "out"));
  {
    const FolderClaim claim(folder);
    write_files_together(folder, {{{"a.txt", "1"}}});
  }
  EXPECT_EQ(names_in(folder), std::vector<std::string>{"a.txt"});
  const FolderClaim again(folder);
}

}  // namespace
}  // namespace lapwing
