// SPDX-License-Identifier: Apache-2.0
// Commands that are lists of items: shards, several processes, bad input.
#include "tests/app/items_fixture.h"

#include <gmock/gmock.h>

namespace lapwing {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(Items, ShardsAreGatheredToTheSameBytes) {
  ASSERT_EQ(shell(explore("whole", "--quiet")).status, 0);
  const Finished first = shell(explore("parts", "--shard 1/2 --json"));
  EXPECT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("\"shard\": \"1/2\""));
  const Finished incomplete = shell(explore("parts", "--gather"));
  EXPECT_EQ(incomplete.status, 2);
  EXPECT_THAT(incomplete.err, AllOf(HasSubstr("--gather: 3 of 6 items in 'parts' are missing: "),
                                    HasSubstr("'episodes/yard.obj_frontier_1.json', ")));
  EXPECT_FALSE(fs::exists(folder_ / "parts/table.csv"));
  const Finished second = shell(explore("parts", "--shard 0/2"));
  EXPECT_EQ(second.status, 0) << second.err;
  EXPECT_THAT(second.out, HasSubstr("shard 2/2 is complete: 3 of 6 items"));
  EXPECT_EQ(shell(explore("parts", "--gather --quiet")).status, 0);
  EXPECT_EQ(bytes("parts"), bytes("whole"));
  const Finished schedule = shell(explore("parts", "--schedule"));
  EXPECT_EQ(schedule.status, 0);
  EXPECT_THAT(schedule.out, HasSubstr("A simulation, not a measurement: 6 items, 6 of them"));
}

TEST_F(Items, BadOptionsAreRefusedBeforeAnythingIsWritten) {
  const std::vector<std::string> words{"evaluate", "explore", "--world", "yard.obj"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return more;
  };
  refused(with({"--shard", "3/2"}), {"--shard: expected K/N with K from 1 to N", "not '3/2'"});
  refused(with({"--shard", "1/2", "--gather"}), {"--shard and --gather"});
  refused(with({"--gather"}), {"--gather: there is no evaluation in 'out/evaluate_explore'"});
  refused(with({"--schedule"}), {"--schedule: there is no evaluation in"});
  refused(with({"--executor", "thread"}), {"unknown executor 'thread'", "threads"});
  refused(with({"--executor", "threads:"}), {"--executor: expected NAME or NAME:KEY=VALUE"});
  refused(with({"--executor", "threads:pace=3"}), {"pace"});
}

// A build without Open MPI misses one plugin, and nothing else.
TEST_F(Items, AnExecutorThatWasNotBuiltIsNamedOnce) {
  const fs::path built = LAPWING_BUILD_DIR, here = folder_ / "without";
  fs::create_directories(here / "bin");
  fs::create_directories(here / "lib/plugins");
  fs::copy_file(built / "bin/lapwing", here / "bin/lapwing");
  fs::copy_file(built / "lib/liblapwing.so", here / "lib/liblapwing.so");
  fs::create_symlink(built / "share", here / "share");
  for (const auto& file : fs::recursive_directory_iterator(built / "lib/plugins")) {
    const fs::path name = file.path().lexically_relative(built / "lib"),
                   there = here / "lib" / name;
    if (file.is_directory())
      fs::create_directories(there);
    else if (name.stem() != "mpi")
      fs::create_symlink(file.path(), there);
  }
  const auto explore_here = [&](const std::string& variables, const std::string& more) {
    std::string line = explore("out", more);
    line.replace(0, line.find(' '), here.string() + "/bin/lapwing");
    return shell("LD_LIBRARY_PATH=" + here.string() + "/lib " + variables + " " + line);
  };
  for (const char* variables : {"", "OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=0"}) {
    const Finished finished = explore_here(variables, *variables ? "" : "--executor mpi");
    EXPECT_EQ(finished.status, 2);
    EXPECT_THAT(finished.err, AllOf(HasSubstr("executor was not built; install libopenmpi-dev"),
                                    HasSubstr("--shard")));
  }
  const Finished other = explore_here("OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=1", "");
  EXPECT_EQ(other.status, 0);
  EXPECT_EQ(other.err, "");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_EQ(explore_here("", "--quiet").status, 0);
  ASSERT_EQ(shell(explore("whole", "--quiet")).status, 0);
  EXPECT_EQ(bytes("out"), bytes("whole"));
}

TEST_F(MpiItems, SeveralProcessesGiveTheSameBytes) {
  ASSERT_EQ(shell(explore("one", "--quiet")).status, 0);
  const Finished finished = shell(mpirun(3) + explore("three"));
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(bytes("three"), bytes("one"));
}

// Four processes have one message.
TEST_F(MpiItems, BadInputIsSaidOnce) {
  for (const char* bad : {"--moves clear=-1", "--gather"}) {
    const Finished finished = shell(mpirun(4) + explore("bad", bad));
    EXPECT_EQ(finished.status, 2) << bad;
    std::size_t count = 0;
    for (std::size_t at = 0; (at = finished.err.find("lapwing: ", at)) != std::string::npos; ++at)
      ++count;
    EXPECT_EQ(count, 1u) << bad << finished.err;
    EXPECT_FALSE(fs::exists(folder_ / "bad")) << bad;
  }
}

}  // namespace
}  // namespace lapwing
