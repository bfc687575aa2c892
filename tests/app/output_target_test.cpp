// SPDX-License-Identifier: Apache-2.0
// Files that commands write (-o) replace no input, script, plan or part of a run.
#include "framework/core/files.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class OutputTarget : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    write("shot.lua",
          "return require('mission.film').shot { name = 'hop', keyframes = { { position = {0, 0, "
          "2} }, { position = {4, 0, 3} } } }");
    const Finished made = run({"run", "shot.lua"});
    ASSERT_EQ(made.status, 0) << made.err;
    plan_ = read_file(folder_ / "out/hop/plan.json");
  }

  // Refused with the words, and the file as it was.
  void keeps(const std::string& file, const std::vector<std::string>& words,
             const std::string& why) {
    const std::string before = read_file(folder_ / file);
    const Finished finished = run(words);
    EXPECT_EQ(finished.status, 2) << words[0] << " over " << file;
    EXPECT_NE(finished.err.find(why), std::string::npos) << finished.err;
    EXPECT_EQ(read_file(folder_ / file), before) << words[0] << " over " << file;
  }

  std::string plan_;
};

TEST_F(OutputTarget, IsNoInputScriptPlanOrPartOfARun) {
  write("plan.json", plan_);
  write("other.json", plan_);
  keeps("plan.json", {"export", "plan.json", "--format", "csv", "-o", "plan.json"},
        "is read by this command");
  keeps("shot.lua", {"export", "plan.json", "--format", "csv", "-o", "shot.lua"}, "is a script");
  keeps("other.json", {"schema", "-o", "other.json"}, "is a plan");
  keeps("shot.lua", {"annotations", "-o", "shot.lua"}, "is a script");
  keeps("out/hop/report.html", {"simulate", "plan.json", "-o", "out/hop/report.html"},
        "belongs to the run in 'out/hop'");
  keeps("out/hop/report.html", {"diff", "plan.json", "other.json", "-o", "out/hop/report.html"},
        "belongs to the run in 'out/hop'");
  keeps("out/hop/report.html",
        {"race", "plan.json", "--pilot", "a.csv", "-o", "out/hop/report.html"},
        "belongs to the run in 'out/hop'");
}

TEST_F(OutputTarget, MayBeWhatWasWrittenBefore) {
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(run({"annotations", "-o", "notes.lua"}).status, 0);
    EXPECT_EQ(run({"simulate", "out/hop/plan.json", "-o", "flown.html"}).status, 0);
    EXPECT_EQ(run({"export", "out/hop/plan.json", "--format", "csv", "-o", "hop.csv"}).status, 0);
  }
}

}  // namespace
}  // namespace lapwing
