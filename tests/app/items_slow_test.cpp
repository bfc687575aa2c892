// SPDX-License-Identifier: Apache-2.0
// Commands that are lists of items, with the label `long`: kills, full disks, other machines,
// mixtures of processes, threads and shards, and the pace of executors.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <thread>

#include "framework/core/random.h"
#include "tests/app/items_fixture.h"

namespace lapwing {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kSlowerMachine = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4 ";

// A box that is scanned.
constexpr const char* kScannedBox = R"(local scan = require "mission.scan"
return scan.of_mesh {
  name = "hut", input = "hut.obj", ground = true,
  region = { lower = {-4, -3.5, -0.5}, upper = {4, 3.5, 4.5} },
  safe_height = 7,
  flights = { { pattern = "circle", height = 9, views = 8, reach = 4 } },
  tour = { budget = 60, iterations = 30 },
  reach = 8, resolution = 0.4,
  camera = { width = 120, height = 90, focal = 70 },
  surface = { spacing = 0.5, cell = 0.6, trim = 1.2 },
  usable = { range = 30 },
  candidates = { most = 40, step = 3, distance_apart = 2 },
  motions = { coarse = 40, alpha = 0.2 },
}
)";

class SlowItems : public MpiItems {
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

TEST_F(SlowItems, TwentyKillsEndAtTheSameBytes) {
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

TEST_F(SlowItems, AKilledProcessLosesItsItemsInFlightOnly) {
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

TEST_F(SlowItems, TwoProcessesThatResumeOneFolderEndAtTheSameBytes) {
  ASSERT_EQ(shell(work(1, "whole")).status, 0);
  const pid_t process = started(work(1, "both"));
  sleep(0.7);
  kill_all(process);
  const std::string resume = work(1, "both");
  const Finished both =
      shell("((" + resume + "; echo $? > first.txt) & " + resume + "; echo $? > second.txt; wait)");
  const int first = std::stoi(read_file(folder_ / "first.txt"));
  const int second = std::stoi(read_file(folder_ / "second.txt"));
  EXPECT_EQ(std::min(first, second), 0) << both.err;
  // The second is refused while the first one works.
  EXPECT_TRUE(std::max(first, second) == 0 || std::max(first, second) == 2) << both.err;
  EXPECT_EQ(bytes("both"), bytes("whole"));
}

// What was made is whole, the message names the file, and with more room it goes on.
TEST_F(SlowItems, AFullDiskIsSaidAndGoesOnWhenThereIsRoom) {
  fs::create_directories(folder_ / "disk");
  if (::geteuid() != 0 || shell("mount -t tmpfs -o size=120k none disk").status != 0)
    GTEST_SKIP() << "a small disk cannot be mounted here; run as root";
  // Also if an assertion ends the test.
  const auto unmount = [this](void*) { shell("umount disk"); };
  const std::unique_ptr<void, decltype(unmount)> mounted(this, unmount);
  ASSERT_EQ(shell(work(1, "whole")).status, 0);
  const Finished full = shell(work(2, "disk/some"));
  EXPECT_EQ(full.status, 2);
  EXPECT_THAT(full.err, AllOf(HasSubstr("cannot write 'disk/some/"), HasSubstr("No space left")));
  if (fs::exists(folder_ / "disk/some")) all_are_whole("disk/some", bytes("whole"));
  EXPECT_EQ(shell("mount -o remount,size=20m disk").status, 0);
  const Finished more = shell(work(2, "disk/some"));
  EXPECT_EQ(more.status, 0) << more.err;
  EXPECT_EQ(bytes("disk/some"), bytes("whole"));
}

// The C library chooses other code for `exp` and `sin` where the processor has no FMA and AVX2.
TEST_F(SlowItems, ResultsOfAnotherMachineAreRefusedUnlessBothArePortable) {
  if (shell(std::string(kSlowerMachine) + explore("probe", "--shard 2/7")).status != 0 ||
      shell(explore("probe", "--shard 3/7")).status == 0)
    GTEST_SKIP() << "this processor has neither FMA nor AVX2, or the C library does not use them";
  ASSERT_EQ(shell(explore("here", "--quiet")).status, 0);
  for (const char* how : {"--resume", "--gather", "--shard 1/2"}) {
    const Finished other = shell(kSlowerMachine + explore("here", how));
    EXPECT_EQ(other.status, 2) << how;
    EXPECT_THAT(other.err, AllOf(HasSubstr("another machine ("), HasSubstr("use --portable")));
  }
  ASSERT_EQ(shell(explore("pinned", "--portable --shard 1/2")).status, 0);
  const Finished there = shell(kSlowerMachine + explore("pinned", "--portable --shard 2/2"));
  ASSERT_EQ(there.status, 0) << there.err;
  ASSERT_EQ(shell(explore("pinned", "--portable --gather --quiet")).status, 0);
  ASSERT_EQ(shell(kSlowerMachine + explore("slow", "--portable --quiet")).status, 0);
  EXPECT_EQ(bytes("pinned"), bytes("slow"));
  // An item that was copied from another machine.
  const std::string name = "/episodes/yard.obj_frontier_1.json";
  write("here" + name, read_file(folder_ / ("slow" + name)));
  const Finished copied = shell(explore("here", "--resume"));
  EXPECT_EQ(copied.status, 2);
  EXPECT_THAT(copied.err, HasSubstr("frontier_1.json' was made on another machine ("));
}

TEST_F(SlowItems, ASweepRunsInAllProcesses) {
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
TEST_F(SlowItems, KeptRunsAreThoseThatAreNotKept) {
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

// The commands that explore and scan, in processes by threads, and in shards of such.
TEST_F(SlowItems, EveryMixtureOfProcessesThreadsAndShardsGivesTheSameBytes) {
  write("hut.lua", kScannedBox);
  write("hut.obj",
        "v -3 -2.5 0\nv 3 -2.5 0\nv 3 2.5 0\nv -3 2.5 0\nv -3 -2.5 4\nv 3 -2.5 4\n"
        "v 3 2.5 4\nv -3 2.5 4\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n"
        "f 4 3 2 1\n");
  const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing ";
  const std::string commands[] = {
      "evaluate explore --world yard.obj --utility frontier --utility oracle --episodes 7 --steps "
      "2 "
      "--quiet -o ",
      "evaluate scan hut.lua --method greedy --method circle_9 --method cost_benefit --seeds 1,2 "
      "--quiet -o ",
      "train dataset --world yard.obj --episodes 5 --steps 2 --quiet -o "};
  int number = 0;
  for (const std::string& command : commands) {
    const std::string kind = std::to_string(++number), whole = "whole_" + kind;
    const Finished first = shell(program + command + whole + " --threads 1");
    ASSERT_EQ(first.status, 0) << first.err;
    const auto expected = bytes(whole);
    EXPECT_GE(expected.size(), 5u);
    for (const auto& [ranks, threads] : {std::pair{1, 3}, {3, 1}, {2, 2}}) {
      const std::string out = "mixed_" + kind + "_" + std::to_string(ranks);
      const Finished mixed = shell((ranks > 1 ? mpirun(ranks) : "") + program + command + out +
                                   " --threads " + std::to_string(threads));
      ASSERT_EQ(mixed.status, 0) << mixed.err;
      EXPECT_EQ(bytes(out), expected) << command << ranks << " by " << threads;
    }
    // Of three shards two at once, and one by several processes.
    const std::string parts = program + command + "parts_" + kind + " --threads 2 ";
    ASSERT_EQ(shell("(" + parts + "--shard 3/3 & " + parts + "--shard 1/3; wait)").status, 0);
    ASSERT_EQ(shell(mpirun(2) + parts + "--shard 2/3").status, 0);
    const Finished gathered = shell(parts + "--gather");
    ASSERT_EQ(gathered.status, 0) << gathered.err;
    EXPECT_EQ(bytes("parts_" + kind), expected) << command;
  }
}

// Two processes by one thread against one by two, and the time beside the items. Others' load only
// slows, so that the best of some tries is what counts.
TEST_F(SlowItems, ProcessesAreAsFastAsThreads) {
  const auto pace = [&](const std::string& how) {
    std::pair<double, double> best{1e9, 1e9};  // s of the whole, ms beside each item
    for (int turn = 0; turn < 5; ++turn) {
      const Finished finished = shell(how);
      EXPECT_EQ(finished.status, 0) << finished.err;
      double whole = 0, beside = 0;
      EXPECT_EQ(std::sscanf(finished.out.c_str(), "%*d processes by %*d threads: %lf s, %lf ms",
                            &whole, &beside),
                2)
          << finished.out;
      best = {std::min(best.first, whole), std::min(best.second, beside)};
    }
    return best;
  };
  const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/executor_pace ";
  const double threads = pace(program + "threads 40 100 2").first;
  const double processes = pace(mpirun(2) + program + "mpi 40 100 1").first;
  EXPECT_GE(threads / processes, 0.95) << threads << " s against " << processes << " s";
  EXPECT_LE(pace(program + "threads 1000 2 2").second, 2);
  EXPECT_LE(pace(mpirun(2) + program + "mpi 1000 2 1").second, 2);
  if (std::thread::hardware_concurrency() >= 4) {
    EXPECT_LE(pace(mpirun(4) + program + "mpi 2000 2 1").second, 2);
  }
}

TEST_F(SlowItems, TooFewItemsAreWarnedOf) {
  const Finished finished = shell(mpirun(5) + explore("few", "", 6));
  EXPECT_EQ(finished.status, 0);
  EXPECT_THAT(finished.err, HasSubstr("warning: 6 items are few for 5 processes by 1 thread"));
}

}  // namespace
}  // namespace lapwing
