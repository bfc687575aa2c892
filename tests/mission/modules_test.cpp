// SPDX-License-Identifier: Apache-2.0
// Runs the tests of the modules of scripts/mission, tests/mission/modules/*_test.lua: each is a
// script that fails where one of its checks does.
#include <algorithm>

#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

std::vector<std::string> module_tests() {
  std::vector<std::string> names;
  for (const auto& item :
       fs::directory_iterator(fs::path(LAPWING_SOURCE_DIR) / "tests/mission/modules")) {
    const std::string name = item.path().stem().string();
    if (name.ends_with("_test")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

MissionSettings settings_with(Registry& registry) {
  MissionSettings settings;
  settings.scripts = fs::path(LAPWING_SOURCE_DIR) / "scripts";
  settings.configs = fs::path(LAPWING_SOURCE_DIR) / "configs";
  settings.registry = &registry;
  return settings;
}

class Modules : public ::testing::TestWithParam<std::string> {};

TEST_P(Modules, DoWhatTheySay) {
  Registry registry({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  const fs::path script =
      fs::path(LAPWING_SOURCE_DIR) / "tests/mission/modules" / (GetParam() + ".lua");
  try {
    Mission mission(script, settings_with(registry));
    mission.configure({}, {});
  } catch (const InputError& wrong) {
    ADD_FAILURE() << wrong.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Scripts, Modules, ::testing::ValuesIn(module_tests()),
                         [](const auto& tested) { return tested.param; });

// A script that fails is heard: the tests above could fail.
TEST_F(MissionTest, AFailedCheckOfAModuleIsHeard) {
  fs::copy_file(fs::path(LAPWING_SOURCE_DIR) / "tests/mission/modules/check.lua",
                folder_ / "check.lua");
  const std::string begin = "local check = require 'check' return check.all { ";
  expect(begin + "wrong = function() check.near({ 1, { 2 } }, { 1, { 2.1 } }, 0.01) end }",
         "1 of 1 fail");
  expect(begin + "longer = function() check.equal({ 1, 2 }, { 1 }) end }", "got {1, 2}");
  expect(begin + "none = function() check.fails('x', function() end) end }", "no error");
  expect(begin + "other = function() check.fails('x', error, 'y') end }", "wanted 'x'");
  expect(begin + "}", "there are no tests");
}

}  // namespace
}  // namespace lapwing
