// SPDX-License-Identifier: Apache-2.0
// lapwing diff: two plans beside each other.
#include <regex>

#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class Comparing : public CommandLine {
 protected:
  void SetUp() override {
    write("shot.lua", film("name = 'hop',"));
    ASSERT_EQ(run({"run", "shot.lua", "-o", "a"}).status, 0);
  }
};

TEST_F(Comparing, TheSamePlanIsTheSame) {
  ASSERT_EQ(run({"run", "shot.lua", "-o", "b"}).status, 0);
  const Finished finished = run({"diff", "a", "b/plan.json"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("the plans are the same"), std::string::npos) << finished.out;
}

TEST_F(Comparing, WhatDiffersIsNamed) {
  ASSERT_EQ(run({"run", "shot.lua", "-o", "b", "--set", "weights.smoothness=1", "--set",
                 "duration=9", "--set", "keyframes[2].position=[7, 0, 3]"})
                .status,
            0);
  Finished finished = run({"diff", "a/report.html", "b", "-o", "page.html"});
  EXPECT_EQ(finished.status, 1) << finished.err;
  for (const char* part :
       {"m apart at the same time", "path length [m]", "Cost of each term", "weights.smoothness",
        "keyframes[2].position", "[7.0,0.0,3.0]", "Task, vehicle and surroundings",
        "task.keyframes[2].position", "Certificate", "speed_across", "at most 10"})
    EXPECT_NE(finished.out.find(part), std::string::npos) << part << "\n" << finished.out;
  EXPECT_EQ(finished.out.find("vehicle.mass"), std::string::npos);
  const std::string page = read_file(folder_ / "page.html");
  for (const char* part : {"Paths from above", "weights.smoothness", "different"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  finished = run({"diff", "a", "b", "--json"});
  EXPECT_EQ(finished.status, 1);
  const Value object = from_json(finished.out, "answer");
  EXPECT_FALSE(object.at("same").as_boolean());
  EXPECT_NEAR(object.at("second").at("figures").at("duration").as_number(), 9, 1e-6);
  EXPECT_GT(object.at("distance").at("worst").as_number(), 0.5);
  EXPECT_FALSE(object.at("checks").as_list().empty());
}

TEST_F(Comparing, OnlyAVehicleThatWasEditedDiffers) {
  std::string text = read_file(folder_ / "a/plan.json");
  const std::string before = "\"speed_across\": 10.0";
  ASSERT_NE(text.find(before), std::string::npos);
  text.replace(text.find(before), before.size(), "\"speed_across\": 20.0");
  write("edited.json", text);
  const Finished finished = run({"diff", "a", "edited.json"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.out.find("vehicle.limits.speed_across"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("both fly the same path"), std::string::npos) << finished.out;
  EXPECT_EQ(finished.out.find("\nOptions\n"), std::string::npos) << finished.out;
}

// Single values are not buried under those of lists.
TEST_F(Comparing, ListsAreFolded) {
  std::string keyframes;
  for (int i = 0; i < 12; ++i)
    keyframes += (i > 0 ? ", " : "") + ("{position: [" + std::to_string(i)) + ", 1, 3]}";
  ASSERT_EQ(run({"run", "shot.lua", "-o", "b", "--set", "keyframes=[" + keyframes + "]", "--set",
                 "finish=free"})
                .status,
            0);
  ASSERT_EQ(
      run({"run", "shot.lua", "-o", "c", "--set",
           "keyframes=[" + std::regex_replace(keyframes, std::regex(", 1, 3"), ", 2, 4") + "]"})
          .status,
      0);
  const Finished finished = run({"diff", "b", "c"});
  const std::size_t options = finished.out.find("\nOptions\n");
  const std::size_t single = finished.out.find("finish", options);
  const std::size_t list = finished.out.find("12 values differ", options);
  ASSERT_NE(list, std::string::npos) << finished.out;
  EXPECT_LT(single, list) << finished.out;
  EXPECT_EQ(finished.out.find("keyframes[7]"), std::string::npos) << finished.out;
}

TEST_F(Comparing, WhatIsNoPlanIsRefused) {
  fs::create_directories(folder_ / "empty");
  refused({"diff", "a", "empty"}, {"'empty': there is no plan 'empty/plan.json'"});
  refused({"diff", "a", "nothing"}, {"there is no plan 'nothing'"});
  refused({"diff", "a"}, {"'lapwing diff' wants PLAN.json|DIR"});
  refused({"diff", "a", "a", "-o", "page"}, {"'page'", ".html"});
}

}  // namespace
}  // namespace lapwing
