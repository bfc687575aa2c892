// SPDX-License-Identifier: Apache-2.0
// What is written and where: run folders that are shared, output that does not arrive, and files
// that are no plans.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <sched.h>
#include <csignal>
#include <random>

#include "framework/core/json.h"
#include "framework/export/report_value.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class OutputTest : public CommandLine {
 protected:
  // A shell's line in the test's folder; `lapwing` is the program.
  Finished shell(const std::string& line) {
    const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing";
    const std::string whole = "cd '" + folder_.string() + "'; lapwing() { '" + program +
                              "' \"$@\"; }; ( " + line + " ) > stdout.txt 2> stderr.txt";
    const pid_t child = ::fork();
    if (child == 0) {
      std::signal(SIGPIPE, SIG_DFL);
      ::execl("/bin/bash", "bash", "-c", whole.c_str(), nullptr);
      ::_exit(98);
    }
    return finish(child);
  }

  std::vector<std::string> names_in(const fs::path& folder) const {
    std::vector<std::string> found;
    for (const auto& item : fs::directory_iterator(folder_ / folder))
      found.push_back(item.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

  // Whether all files of a run are of the same one: the plan, its samples and its log.
  std::string mission_of(const fs::path& folder) {
    const std::string plan =
        from_json(read_file(folder_ / folder / "plan.json"), "plan").at("mission").as_text();
    const std::string log = read_file(folder_ / folder / "run.log");
    const std::string page = read_file(folder_ / folder / "report.html");
    const bool whole = log.find("mission " + plan + ",") != std::string::npos &&
                       page.find("<title>" + plan) != std::string::npos;
    return whole ? plan : "several";
  }
};

const std::vector<std::string> kRunFiles{"plan.json", "report.html", "run.log", "trajectory.csv"};

TEST_F(OutputTest, ThatCannotBeWrittenIsAnError) {
  write("shot.lua", film("name = 'shot'"));
  ASSERT_EQ(run({"run", "shot.lua"}).status, 0);
  for (const char* words :
       {"run shot.lua", "run shot.lua --json", "config shot.lua", "config shot.lua --json",
        "verify out/shot/plan.json", "verify out/shot/plan.json --json",
        "simulate out/shot/plan.json", "plugins list", "plugins list --json", "plugins path",
        "schema film", "annotations", "--version", "--help", "run --help"}) {
    const Finished full = shell(std::string("lapwing ") + words + " > /dev/full");
    EXPECT_EQ(full.status, 3) << words;
    EXPECT_THAT(full.err, HasSubstr("cannot write to standard output")) << words;
    const Finished closed = shell(std::string("lapwing ") + words + " >&-");
    EXPECT_EQ(closed.status, 3) << words;
  }
  EXPECT_EQ(shell("lapwing run shot.lua --quiet > /dev/full").status, 0) << "nothing was to say";
}

// As with `head`: nothing is said, and the status is the one that shells show of other tools.
TEST_F(OutputTest, AReaderThatGoesAwayIsNoFault) {
  write("shot.lua", film("name = 'shot'"));
  write("late.lua", film("name = 'late', duration = 0.7"));
  const auto unread = [&](const std::string& words) {
    shell("( sleep 0.3; lapwing " + words +
          " 2> errors; echo $? > status ) | true; while [ ! -s status ]; do sleep 0.05; done");
    const std::string status = read_file(folder_ / "status");
    fs::remove(folder_ / "status");
    return status;
  };
  for (const char* words :
       {"annotations", "config shot.lua --json", "plugins list", "run shot.lua --json --quiet"}) {
    EXPECT_EQ(unread(words), "141\n") << words;
    EXPECT_EQ(read_file(folder_ / "errors"), "") << words;
  }
  EXPECT_EQ(mission_of("out/shot"), "shot") << "files are written all the same";
  EXPECT_EQ(unread("run late.lua --json --quiet"), "1\n") << "what failed is told";
  EXPECT_EQ(unread("run missing.lua"), "2\n");
  EXPECT_THAT(read_file(folder_ / "errors"), HasSubstr("missing.lua"));
  const Finished piped = shell("lapwing annotations | head -1; exit ${PIPESTATUS[0]}");
  EXPECT_EQ(piped.status, 141);
  EXPECT_EQ(piped.err, "");
  EXPECT_EQ(std::count(piped.out.begin(), piped.out.end(), '\n'), 1);
}

TEST_F(OutputTest, AnEmptyNameIsRefused) {
  write("shot.lua", film("name = 'shot'"));
  refused({"run", "shot.lua", "-o", ""}, {"-o,--out", "expected DIR, not an empty text"});
  refused({"run", "shot.lua", "--out="}, {"'--out' wants DIR"});
  refused({"run", ""}, {"mission", "expected MISSION.lua"});
  refused({"verify", ""}, {"expected PLAN.json"});
  refused({"schema", "film", "-o", ""}, {"not an empty text"});
}

TEST_F(OutputTest, AScriptIsNoPlan) {
  write("shot.lua", film("name = 'shot'"));
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"verify", "shot.lua"},
        {"simulate", "shot.lua"},
        {"export", "shot.lua", "--format", "csv", "-o", "x.csv"},
        {"race", "shot.lua", "--pilot", "x.csv"}})
    refused(words, {"'shot.lua' is a script, not a plan; `lapwing run shot.lua` makes one"});
}

TEST_F(OutputTest, APipeIsNotWaitedForWithoutEnd) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  refused({"verify", "pipe"}, {"cannot read 'pipe': nobody has written into it for 5 s"});
}

TEST_F(OutputTest, NamesThatMakeOneFolderDoNotShareItInSilence) {
  write("a.lua", film("name = 'a/b'"));
  write("b.lua", film("name = 'a_b'"));
  ASSERT_EQ(run({"run", "a.lua"}).status, 0);
  refused({"run", "b.lua"}, {"'out/a_b' contains the run of mission 'a/b'", "'a_b'", "--out"},
          true);
  EXPECT_EQ(mission_of("out/a_b"), "a/b");
  const Finished named = run({"run", "b.lua", "-o", "out/a_b"});
  EXPECT_EQ(named.status, 0);
  EXPECT_THAT(named.out, HasSubstr("replaces the run of 'a/b' in this folder"));
  write("a.lua", film("name = '.'"));
  write("b.lua", film("name = '~'"));
  ASSERT_EQ(run({"run", "a.lua"}).status, 0);
  refused({"run", "b.lua"}, {"contains the run of mission '.'"}, true);
}

TEST_F(OutputTest, ARunSaysWhatItReplacesOrKeepsIt) {
  write("shot.lua", film("name = 'shot'"));
  EXPECT_THAT(run({"run", "shot.lua"}).out, Not(HasSubstr("that was there")));
  EXPECT_THAT(run({"run", "shot.lua"}).out, HasSubstr("replaces the run in this folder"));
  write_file_atomically(folder_ / "out/shot/notes.txt", "mine");
  EXPECT_THAT(run({"run", "shot.lua", "--keep"}).out,
              HasSubstr("the run that was there is kept in 'out/shot.1'"));
  EXPECT_EQ(read_file(folder_ / "out/shot.1/notes.txt"), "mine");
  const Finished third = run({"run", "shot.lua", "--keep", "--json"});
  EXPECT_EQ(from_json(third.out, "answer").at("kept").as_text(), "out/shot.2");
  EXPECT_EQ(names_in("out"), (std::vector<std::string>{"shot", "shot.1", "shot.2"}));
  EXPECT_EQ(names_in("out/shot"), kRunFiles);
  EXPECT_EQ(mission_of("out/shot.1"), "shot");
  refused({"run", "shot.lua", "-o", ".", "--keep"}, {"'.' cannot be kept under another name"});
}

TEST_F(OutputTest, WhatNoRunWroteIsNotLost) {
  write("shot.lua", film("name = 'shot'"));
  write("mine/report.html", "precious");
  refused({"run", "shot.lua", "-o", "mine"}, {"'mine' holds 'report.html', which no run wrote"});
  EXPECT_EQ(read_file(folder_ / "mine/report.html"), "precious");
  write("other/letter.txt", "mine");
  write("other/obstacle_course.ply", "mine");
  EXPECT_EQ(run({"run", "shot.lua", "-o", "other"}).status, 0);
  EXPECT_EQ(run({"run", "shot.lua", "-o", "other"}).status, 0);
  EXPECT_EQ(names_in("other").size(), kRunFiles.size() + 2);
}

// report.json says what report.html shows; a run without it leaves none of an older run.
TEST_F(OutputTest, TheReportIsWrittenAsDataWhenAskedFor) {
  write("shot.lua",
        film("name = 'shot', subject = { position = {2, 6, 1}, height = 2, width = 1 }"));
  ASSERT_EQ(run({"run", "shot.lua", "--report-data"}).status, 0);
  const std::string data = read_file(folder_ / "out/shot/report.json");
  const Report report = report_from_value(from_json(data, "report.json"));
  EXPECT_EQ(render_html(report), read_file(folder_ / "out/shot/report.html"));
  ASSERT_EQ(run({"run", "shot.lua"}).status, 0);
  EXPECT_EQ(names_in("out/shot"), kRunFiles);
}

TEST_F(OutputTest, TwoRunsIntoOneNewFolder) {
  // It plans until it is ended.
  write("slow.lua",
        "return { kind = 'film', name = 'slow', options = {}, plan = function(run)\n"
        "  print('begun'); local t = os and os.clock and os.clock() or 0\n"
        "  for i = 1, 2e9 do t = t + i end\nend }\n");
  write("shot.lua", film("name = 'shot'"));
  const pid_t first = start({"run", "slow.lua", "-o", "new"});
  EXPECT_TRUE(speaks());
  fs::create_directory(folder_ / "elsewhere");
  const Finished second = shell("cd elsewhere; lapwing run ../shot.lua -o ../new");
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.err, HasSubstr("another process is writing into '../new'"));
  ::kill(first, SIGKILL);
  int status = 0;
  ::waitpid(first, &status, 0);
  EXPECT_EQ(run({"run", "shot.lua", "-o", "new"}).status, 0) << "a dead run holds nothing";
}

// "certified" is not followed by what failed on the way, unless that is asked for.
TEST_F(OutputTest, DetailsAreShownWhenAskedForOrNotCertified) {
  const auto hover = [](const std::string& budget) {
    return "return { kind = 'test', name = 'hover', options = {}, plan = function(run)\n"
           "  local p = run:problem { vehicle = run:vehicle('vehicles/solo'), duration = 1 }\n"
           "  p:add_model { type = 'quadrotor' }\n  p:add_cost { type = 'input_effort' }\n"
           "  p:finish()\n  return run:plan { solution = run:solve(p, 'iqp'), budget = " +
           budget + ",\n    notes = {'a note'}, details = {'passage 1 came to nothing'} }\nend }\n";
  };
  write("shot.lua", hover("5"));
  Finished shown = run({"run", "shot.lua"});
  EXPECT_EQ(shown.status, 0) << shown.out << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("a note"));
  EXPECT_THAT(shown.out, Not(HasSubstr("passage 1")));
  EXPECT_THAT(run({"run", "shot.lua", "--verbose"}).out, HasSubstr("passage 1 came to nothing"));
  EXPECT_THAT(read_file(folder_ / "out/hover/run.log"), HasSubstr("passage 1 came to nothing"));
  EXPECT_THAT(read_file(folder_ / "out/hover/report.html"), HasSubstr("passage 1 came"));
  EXPECT_EQ(from_json(run({"run", "shot.lua", "--json"}).out, "").at("notes").as_list().size(), 2u);
  write("shot.lua", hover("0.5"));
  shown = run({"run", "shot.lua"});
  EXPECT_EQ(shown.status, 1);
  EXPECT_THAT(shown.out, HasSubstr("passage 1 came to nothing"));
}

// A file may not grow beyond 20 kB: the report does not fit, the plan hardly.
TEST_F(OutputTest, AFullDiskKeepsTheLastRun) {
  write("old.lua", film("name = 'old'"));
  write("new.lua", film("name = 'new'"));
  ASSERT_EQ(run({"run", "old.lua", "-o", "shot"}).status, 0);
  const Finished full = shell("ulimit -f 20; trap '' XFSZ; lapwing run new.lua -o shot --json");
  EXPECT_EQ(full.status, 2) << full.err;
  EXPECT_THAT(full.err, HasSubstr("cannot write 'shot/"));
  EXPECT_THAT(full.err, HasSubstr("File too large"));
  EXPECT_EQ(mission_of("shot"), "old");
  EXPECT_EQ(names_in("shot"), kRunFiles);
  EXPECT_EQ(shell("ulimit -f 20; trap '' XFSZ; lapwing run new.lua -o shot --keep").status, 2);
  EXPECT_EQ(mission_of("shot"), "old");
  EXPECT_FALSE(fs::exists(folder_ / "shot.1"));
}

TEST_F(OutputTest, ATrulyFullDiskKeepsTheLastRun) {
  write("old.lua", film("name = 'old'"));
  write("new.lua", film("name = 'new'"));
  fs::create_directory(folder_ / "disk");
  const Finished full = shell(
      "unshare -m --propagation private bash -c '"
      "mount -t tmpfs -o size=256k none disk || exit 77; "
      "\"$0\" run old.lua -o disk/shot --quiet || exit 78; "
      "head -c 300000 /dev/zero > disk/filler 2> /dev/null; "
      "\"$0\" run new.lua -o disk/shot; status=$?; "
      "cp -a disk/shot after; exit $status' '" +
      std::string(LAPWING_BUILD_DIR) + "/bin/lapwing' || exit $?");
  if (full.status == 77 || full.err.find("unshare") != std::string::npos)
    GTEST_SKIP() << "no file system can be mounted here";
  EXPECT_EQ(full.status, 2) << full.err << full.out;
  EXPECT_THAT(full.err, HasSubstr("No space left on device"));
  EXPECT_EQ(mission_of("after"), "old");
  EXPECT_EQ(names_in("after"), kRunFiles);
}

// Runs of two missions in turn into one folder, each killed at a random moment.
TEST_F(OutputTest, KilledRunsLeaveOneRunWhole) {
  write("old.lua", film("name = 'old'"));
  write("new.lua", film("name = 'new'"));
  ASSERT_EQ(run({"run", "old.lua", "-o", "shot"}).status, 0);
  std::mt19937 random(3);
  for (int kill = 0; kill < 24; ++kill) {
    const pid_t child = start({"run", kill % 2 ? "old.lua" : "new.lua", "-o", "shot"});
    ::usleep(20000 + random() % 150000);
    ::kill(child, SIGKILL);
    finish(child);
    const Finished judged = run({"verify", "shot/plan.json"});  // completes what was decided
    EXPECT_EQ(judged.status, 0) << judged.out << judged.err;
    EXPECT_NE(mission_of("shot"), "several");
  }
  EXPECT_EQ(run({"run", "old.lua", "-o", "shot"}).status, 0);
  EXPECT_EQ(names_in("shot"), kRunFiles) << "what the dead left is cleared";
}

}  // namespace
}  // namespace lapwing
