// SPDX-License-Identifier: Apache-2.0
// What two evaluations differ in: the first setting that does, by name, with both its values.
#include "framework/study/study_settings.h"

#include <gtest/gtest.h>

#include "framework/core/json.h"

namespace lapwing {
namespace {

Value settings(const std::string& json) {
  return from_json(json, "settings");
}

std::string differs(const std::string& there, const std::string& here) {
  return settings_difference(settings(there), settings(here));
}

TEST(StudySettings, FileNamesHoldNothingElse) {
  EXPECT_EQ(file_text("office 2/a.obj"), "office_2_a.obj");
  EXPECT_EQ(file_text("A-z.09"), "A-z.09");
  EXPECT_EQ(file_text("../x"), ".._x");
  EXPECT_EQ(file_text("\xc3\xa9\n"), "___");
  EXPECT_EQ(file_text(""), "");
}

TEST(StudySettings, AMapIsShownOnOneLine) {
  EXPECT_EQ(settings_text(settings("{}")), "");
  EXPECT_EQ(settings_text(settings(R"({"step": 0.7, "clear": [1, 2], "name": "a"})")),
            "step 0.7, clear [1,2], name \"a\"");
}

TEST(StudySettings, TheFirstDifferenceIsNamed) {
  const std::string same = R"({"seed": 1, "moves": {"step": 1}, "files": {"a": "1"}})";
  EXPECT_EQ(differs(same, same), "");
  EXPECT_EQ(differs(R"({"seed": 2, "files": {}})", R"({"seed": 1, "files": {}})"),
            "seed is 2 there, 1 here");
  EXPECT_EQ(differs(R"({"files": {}})", R"({"seed": 1, "files": {}})"),
            "seed is not said there, 1 here");
  EXPECT_EQ(differs(R"({"seed": [1], "files": {}})", R"({"files": {}})"),
            "seed is [1] there, not said here");
  EXPECT_EQ(differs("3", same), "its settings are not stated");
  EXPECT_EQ(differs("null", same), "its settings are not stated");
}

// A folder that is joined by other worlds and utilities still agrees on those of both.
TEST(StudySettings, FilesOfBothMustBeTheSame) {
  const auto with = [](const std::string& files) { return "{\"files\": " + files + "}"; };
  EXPECT_EQ(differs(with(R"({"a": "1", "b": "2"})"), with(R"({"b": "2", "c": "3"})")), "");
  EXPECT_EQ(differs(with(R"({"a": "1"})"), with(R"({"a": "2"})")), "the file of a is another one");
  EXPECT_EQ(differs("{}", with(R"({"a": "2"})")), "");
}

// A world has its own moves, or else those of all.
TEST(StudySettings, MovesAreThoseOfTheWorld) {
  const auto with = [](const std::string& moves, const std::string& own,
                       const std::string& files = R"({"a": "1", "b": "2"})") {
    return R"({"moves": )" + moves + R"(, "world_moves": )" + own + R"(, "files": )" + files + "}";
  };
  const std::string one = R"({"step": 1})", two = R"({"step": 2})";
  EXPECT_EQ(differs(with(one, R"({"a": {"step": 2}})"), with(one, R"({"a": {"step": 2}})")), "");
  EXPECT_EQ(differs(with(one, R"({"a": {"step": 2}})"), with(one, R"({"a": {"step": 3}})")),
            "the moves in a are step 2 there, step 3 here");
  // Named on one side only: the other side's are those of all.
  EXPECT_EQ(differs(with(one, "{}"), with(one, R"({"a": {"step": 3}})")),
            "the moves in a are step 1 there, step 3 here");
  EXPECT_EQ(differs(with(one, R"({"a": {"step": 3}})"), with(one, "{}")),
            "the moves in a are step 3 there, step 1 here");
  EXPECT_EQ(differs(with(one, R"({"a": {"step": 1}})"), with(one, "{}")), "");
  EXPECT_EQ(differs(with(two, "{}"), with(one, "{}")),
            R"(moves is {"step":2} there, {"step":1} here)");
  // A world that only one of them has does not matter.
  EXPECT_EQ(differs(with(one, R"({"c": {"step": 9}})", R"({"c": "1"})"), with(one, "{}")), "");
}

}  // namespace
}  // namespace lapwing
