// SPDX-License-Identifier: Apache-2.0
// Options that a file takes the place of are not told as if they were flown.
#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

TEST_F(CommandLine, WhatAFileReplacesIsNotInTheConfiguration) {
  write("course.lua",
        "return require 'mission.race'.course { start = {-8, 0, 2}, finish = {12, 6, 2}, gates = { "
        "{ name = 'of the script', shape = 'ball', position = {0, 0, 2}, radius = 1 } } }");
  write("other.yaml",
        "start: [0, 0, 2]\nend: [9, 0, 2]\ngates:\n  - {shape: ball, position: [4, 0, 2], radius: "
        "1}\n");
  const Finished own = run({"config", "course.lua", "--json"});
  EXPECT_NE(own.out.find("of the script"), std::string::npos) << own.out << own.err;
  const Finished other = run({"config", "course.lua", "--set", "input=other.yaml", "--json"});
  ASSERT_EQ(other.status, 0) << other.err;
  const Value said = from_json(other.out, "stdout");
  for (const char* replaced : {"gates", "keyframes", "start", "finish"})
    EXPECT_EQ(said.find(replaced), nullptr) << replaced;
  EXPECT_EQ(said.at("input").as_text(), "other.yaml");
}

}  // namespace
}  // namespace lapwing
