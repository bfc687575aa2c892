// SPDX-License-Identifier: Apache-2.0
// Commands that are lists of items: shards, other machines, several processes, kills.
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <thread>

#include "framework/core/random.h"
#include "tests/app/program_fixture.h"
#include "tests/tool.h"

namespace lapwing {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kSlower = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4 ";

class Items : public CommandLine {
 protected:
  Items() {
    write("yard.obj",
          "v 0 0 0\nv 12 0 0\nv 12 12 0\nv 0 12 0\nv 4 4 0\nv 7 4 0\nv 7 7 0\nv 4 7 0\n"
          "v 4 4 4\nv 7 4 4\nv 7 7 4\nv 4 7 4\nf 1 2 3 4\nf 9 10 11 12\nf 5 6 10 9\n"
          "f 6 7 11 10\nf 7 8 12 11\nf 8 5 9 12\n");
  }

  // An item takes a few milliseconds.
  std::string explore(const std::string& out, const std::string& more = "", int episodes = 6,
                      int steps = 1) const {
    return std::string(LAPWING_BUILD_DIR) +
           "/bin/lapwing evaluate explore --world yard.obj --utility frontier --threads 1 "
           "--episodes " +
           std::to_string(episodes) + " --steps " + std::to_string(steps) + " -o " + out + " " +
           more;
  }

  // Of a line of the shell, in the test's folder.
  Finished shell(const std::string& line) const {
    Finished finished;
    const int status =
        std::system(("cd '" + folder_.string() + "' && " + line + " > out.txt 2> err.txt").c_str());
    finished.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    finished.out = read_file(folder_ / "out.txt");
    finished.err = read_file(folder_ / "err.txt");
    return finished;
  }

  // Results, without times.
  std::map<std::string, std::string> bytes(const std::string& out) const {
    std::map<std::string, std::string> all;
    for (const auto& item : fs::recursive_directory_iterator(folder_ / out)) {
      const std::string name = item.path().lexically_relative(folder_ / out).string();
      if (item.is_regular_file() && !name.starts_with("times") && !name.starts_with("seconds"))
        all[name] = read_file(item.path());
    }
    return all;
  }
};

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

// As `mpi` is missed where it was not built: plugins are then in a folder of their own.
TEST_F(Items, AnExecutorThatWasNotBuiltIsNamed) {
  const fs::path built = std::string(LAPWING_BUILD_DIR) + "/lib/plugins/executors/mpi.json";
  if (fs::exists(built)) GTEST_SKIP() << "the executor mpi is built";
  for (const char* how : {"", "OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=0 "}) {
    const Finished finished = shell(how + explore("out", *how ? "" : "--executor mpi"));
    EXPECT_EQ(finished.status, 2);
    EXPECT_THAT(finished.err, AllOf(HasSubstr("executor was not built; install libopenmpi-dev"),
                                    HasSubstr("--shard")));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
}

class MpiItems : public Items {
 protected:
  void SetUp() override {
    if (!fs::exists(LAPWING_BUILD_DIR "/lib/plugins/executors/mpi.json"))
      GTEST_SKIP() << "the executor mpi is not built; install libopenmpi-dev";
    if (tool_on_path({"mpirun"}).empty()) GTEST_SKIP() << "no mpirun; install openmpi-bin";
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  }
  static std::string mpirun(int ranks) {
    return "mpirun --oversubscribe -n " + std::to_string(ranks) + " ";
  }
};

TEST_F(MpiItems, AnyNumberOfProcessesGivesTheSameBytes) {
  ASSERT_EQ(shell(explore("one", "--quiet")).status, 0);
  for (const int ranks : {2, 4}) {
    const std::string out = "of_" + std::to_string(ranks);
    const Finished finished = shell(mpirun(ranks) + explore(out));
    ASSERT_EQ(finished.status, 0) << finished.err;
    EXPECT_EQ(bytes(out), bytes("one")) << ranks;
  }
}

// Four processes have one message.
TEST_F(MpiItems, BadInputIsSaidOnce) {
  for (const char* bad : {"--worlds x", "--moves clear=-1", "--gather"}) {
    const Finished finished = shell(mpirun(4) + explore("bad", bad));
    EXPECT_EQ(finished.status, 2) << bad;
    std::size_t count = 0;
    for (std::size_t at = 0; (at = finished.err.find("lapwing: ", at)) != std::string::npos; ++at)
      ++count;
    EXPECT_EQ(count, 1u) << bad << finished.err;
    EXPECT_FALSE(fs::exists(folder_ / "bad")) << bad;
  }
}

// With the label `long`.
class LongItems : public MpiItems {
 protected:
  static constexpr int kEpisodes = 40, kSteps = 3;

  // Starts a line of the shell in a group of its own.
  pid_t started(const std::string& line) const {
    const pid_t child = ::fork();
    if (child == 0) {
      ::setpgid(0, 0);
      if (::chdir(folder_.c_str()) != 0) ::_exit(99);
      ::execl("/bin/sh", "sh", "-c", ("exec " + line + " > kill.txt 2>&1").c_str(), nullptr);
      ::_exit(98);
    }
    ::setpgid(child, child);
    return child;
  }
  // mpirun starts its processes itself.
  static std::vector<pid_t> children_of(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/task/" + std::to_string(process) +
                       "/children");
    return {std::istream_iterator<pid_t>(file), std::istream_iterator<pid_t>()};
  }
  // Kills it and all that it started, and waits until they are gone.
  static void kill_all(pid_t process) {
    const std::vector<pid_t> children = children_of(process);
    ::kill(-process, SIGKILL);
    for (const pid_t child : children) ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(process, &status, 0);
    for (const pid_t child : children)
      for (int wait = 0; wait < 200 && ::kill(child, 0) == 0; ++wait)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  static void sleep(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  }

  std::string work(int ranks, const std::string& out) const {
    const bool begun = fs::exists(folder_ / out / "settings.json");
    return (ranks > 1 ? mpirun(ranks) : "") +
           explore(out, begun ? "--resume --quiet" : "--quiet", kEpisodes, kSteps);
  }
  void all_are_whole(const std::string& out, const std::map<std::string, std::string>& whole) {
    for (const auto& [name, text] : bytes(out))
      if (name.starts_with("episodes/") && name.find(".tmp-") == name.npos) {
        EXPECT_EQ(text, whole.at(name)) << name;
      }
  }
};

TEST_F(LongItems, TwentyKillsEndAtTheSameBytes) {
  ASSERT_EQ(shell(work(1, "whole")).status, 0);
  const auto whole = bytes("whole");
  Random random(static_cast<std::uint64_t>(::getpid()));
  for (const int ranks : {1, 2}) {
    const std::string out = "broken_" + std::to_string(ranks);
    for (int kill = 0; kill < 20; ++kill) {
      const pid_t process = started(work(ranks, out));
      sleep(random.uniform(0.02, ranks > 1 ? 1.6 : 1.0));
      kill_all(process);
      if (fs::exists(folder_ / out)) all_are_whole(out, whole);
    }
    const Finished finished = shell(work(ranks, out));
    ASSERT_EQ(finished.status, 0) << finished.err;
    EXPECT_EQ(bytes(out), whole) << ranks;
  }
}

TEST_F(LongItems, AKilledProcessLosesItsItemsInFlightOnly) {
  ASSERT_EQ(shell(work(1, "whole")).status, 0);
  const auto whole = bytes("whole");
  const pid_t mpirun = started(work(2, "some"));
  for (int wait = 0; wait < 1000 && !fs::exists(folder_ / "some/times/items.txt"); ++wait)
    sleep(0.01);
  sleep(0.2);
  const std::vector<pid_t> ranks = children_of(mpirun);
  ASSERT_EQ(ranks.size(), 2u);
  ::kill(ranks[1], SIGKILL);
  int status = 0;
  ::waitpid(mpirun, &status, 0);
  EXPECT_NE(status, 0);
  EXPECT_THAT(read_file(folder_ / "kill.txt"), HasSubstr("signal 9"));
  const auto left = bytes("some");
  EXPECT_GE(left.size(), 3u);
  all_are_whole("some", whole);
  ASSERT_EQ(shell(work(2, "some")).status, 0);
  EXPECT_EQ(bytes("some"), whole);
}

TEST_F(LongItems, TwoProcessesThatResumeOneFolderEndAtTheSameBytes) {
  ASSERT_EQ(shell(work(1, "whole")).status, 0);
  const pid_t process = started(work(1, "both"));
  sleep(0.7);
  kill_all(process);
  const std::string resume = work(1, "both");
  const Finished both =
      shell("(" + resume + "; echo $? > first.txt) & " + resume + "; echo $? > second.txt; wait");
  const int first = std::stoi(read_file(folder_ / "first.txt"));
  const int second = std::stoi(read_file(folder_ / "second.txt"));
  EXPECT_EQ(std::min(first, second), 0) << both.err;
  // The second is refused while the first one works.
  EXPECT_TRUE(std::max(first, second) == 0 || std::max(first, second) == 2) << both.err;
  EXPECT_EQ(bytes("both"), bytes("whole"));
}

// What was made is whole, the message names the file, and with more room it goes on.
TEST_F(LongItems, AFullDiskIsSaidAndGoesOnWhenThereIsRoom) {
  fs::create_directories(folder_ / "disk");
  if (::geteuid() != 0 || shell("mount -t tmpfs -o size=120k none disk").status != 0)
    GTEST_SKIP() << "a small disk cannot be mounted here; run as root";
  ASSERT_EQ(shell(work(1, "whole")).status, 0);
  const Finished full = shell(work(2, "disk/some"));
  EXPECT_EQ(full.status, 2);
  EXPECT_THAT(full.err, AllOf(HasSubstr("cannot write 'disk/some/"), HasSubstr("No space left")));
  if (fs::exists(folder_ / "disk/some")) all_are_whole("disk/some", bytes("whole"));
  EXPECT_EQ(shell("mount -o remount,size=20m disk").status, 0);
  const Finished more = shell(work(2, "disk/some"));
  EXPECT_EQ(more.status, 0) << more.err;
  EXPECT_EQ(bytes("disk/some"), bytes("whole"));
  shell("umount disk");
}

// The C library chooses other code for `exp` and `sin` where the processor has no FMA and AVX2.
TEST_F(LongItems, ResultsOfAnotherMachineAreRefusedUnlessBothArePortable) {
  if (shell(std::string(kSlower) + explore("probe", "--shard 2/7")).status != 0 ||
      shell(explore("probe", "--shard 3/7")).status == 0)
    GTEST_SKIP() << "this processor has neither FMA nor AVX2, or the C library does not use them";
  ASSERT_EQ(shell(explore("here", "--quiet")).status, 0);
  for (const char* how : {"--resume", "--gather", "--shard 1/2"}) {
    const Finished other = shell(kSlower + explore("here", how));
    EXPECT_EQ(other.status, 2) << how;
    EXPECT_THAT(other.err, AllOf(HasSubstr("another machine ("), HasSubstr("use --portable")));
  }
  ASSERT_EQ(shell(explore("pinned", "--portable --shard 1/2")).status, 0);
  const Finished there = shell(kSlower + explore("pinned", "--portable --shard 2/2"));
  ASSERT_EQ(there.status, 0) << there.err;
  ASSERT_EQ(shell(explore("pinned", "--portable --gather --quiet")).status, 0);
  ASSERT_EQ(shell(kSlower + explore("slow", "--portable --quiet")).status, 0);
  EXPECT_EQ(bytes("pinned"), bytes("slow"));
  // An item that was copied from another machine.
  const std::string name = "/episodes/yard.obj_frontier_1.json";
  write("here" + name, read_file(folder_ / ("slow" + name)));
  const Finished copied = shell(explore("here", "--resume"));
  EXPECT_EQ(copied.status, 2);
  EXPECT_THAT(copied.err, HasSubstr("frontier_1.json' was made on another machine ("));
}

TEST_F(LongItems, ASweepRunsInAllProcesses) {
  write("shot.lua", film("name = 'hop',"));
  const std::string sweep = std::string(LAPWING_BUILD_DIR) +
                            "/bin/lapwing sweep shot.lua --vary weights.effort=0.01,0.1,1 --quiet";
  ASSERT_EQ(shell(sweep + " -o one").status, 0);
  const Finished finished = shell(mpirun(2) + sweep + " -o two");
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_TRUE(fs::exists(folder_ / "two/table.csv"));  // with the solvers' times
  for (const char* run : {"run_001", "run_002", "run_003"})
    EXPECT_EQ(read_file(folder_ / "one" / run / "plan.json"),
              read_file(folder_ / "two" / run / "plan.json"));
}

// Kept runs read back as the same bits: output and page are those of runs that are not kept.
TEST_F(LongItems, KeptRunsAreThoseThatAreNotKept) {
  write("shot.lua", film("name = 'hop',"));
  const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing ";
  ASSERT_EQ(shell(program + "run shot.lua --quiet -o hop").status, 0);
  const std::string simulate = program +
                               "simulate hop/plan.json --runs 6 --mass-error 5 "
                               "--noise 0.01,0.02,0.2,1 --tolerance 0.5 --json ";
  const Finished apart = shell(simulate + "-o apart.html");
  ASSERT_EQ(apart.status, 0) << apart.err;
  EXPECT_EQ(shell(simulate + "--shard 1/3 --keep-runs kept").status, 0);
  const Finished kept = shell(mpirun(2) + simulate + "--resume --keep-runs kept -o kept.html");
  ASSERT_EQ(kept.status, 0) << kept.err;
  EXPECT_EQ(kept.out, apart.out);
  EXPECT_EQ(read_file(folder_ / "kept.html"), read_file(folder_ / "apart.html"));
  EXPECT_TRUE(fs::exists(folder_ / "kept/runs/seed_6.json"));
  const Finished other = shell(simulate + "--resume --keep-runs kept --wind 1,0");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("has other inputs: conditions"));
  for (const char* without : {"--resume", "--shard 1/2", "--executor threads"}) {
    const Finished refused = shell(simulate + without);
    EXPECT_EQ(refused.status, 2) << without;
    EXPECT_THAT(refused.err, HasSubstr("need --runs N and --keep-runs DIR")) << without;
  }
}

TEST_F(LongItems, TooFewItemsAreWarnedOf) {
  const Finished finished = shell(mpirun(5) + explore("few", "", 6));
  EXPECT_EQ(finished.status, 0);
  EXPECT_THAT(finished.err, HasSubstr("warning: 6 items are few for 5 processes by 1 thread"));
}

}  // namespace
}  // namespace lapwing
