// SPDX-License-Identifier: Apache-2.0
// Messages of errors: where, what, all of it together; and what escapes from plugins.
#include "framework/core/error.h"

#include <gtest/gtest.h>

#include <functional>
#include <new>

namespace lapwing {
namespace {

template <class Thrown>
std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Thrown& error) {
    return error.what();
  } catch (...) {
    return "something else";
  }
  return "nothing";
}

TEST(InputErrors, SayWhereAndWhat) {
  EXPECT_EQ((Origin{"shot.lua", 12}.to_string()), "shot.lua:12");
  EXPECT_EQ((Origin{"--set", 0}.to_string()), "--set");
  EXPECT_EQ(Origin{}.to_string(), "");
  EXPECT_STREQ(InputError({"shot.lua", 3}, "too fast").what(), "shot.lua:3: too fast");
  EXPECT_STREQ(InputError(Origin{}, "too fast").what(), "too fast");
}

// A message is read as a C string: what a NUL would cut off is still read.
TEST(InputErrors, ANulDoesNotEndTheMessage) {
  const std::string name("a\0b\0", 4);
  EXPECT_STREQ(InputError({"f", 1}, "'" + name + "' is unknown").what(),
               "f:1: 'a\\0b\\0' is unknown");
  Diagnostics errors;
  errors.add({"f", 1}, name, "is unknown");
  EXPECT_EQ(errors.to_string(), "f:1: a\\0b\\0: is unknown");
}

TEST(InputErrors, AreCollectedInOrder) {
  Diagnostics errors;
  EXPECT_TRUE(errors.empty());
  EXPECT_NO_THROW(errors.throw_if_any());
  EXPECT_EQ(errors.to_string(), "");
  errors.add({"a.yaml", 2}, "weights.snap", "expected a number");
  errors.add({}, "", "nothing to do");
  EXPECT_EQ(errors.lines().size(), 2u);
  EXPECT_EQ(message_of<InputError>([&] { errors.throw_if_any(); }),
            "a.yaml:2: weights.snap: expected a number\nnothing to do");
}

TEST(PluginErrors, NamePluginAndCall) {
  const auto from = [](auto thrown) {
    return message_of<PluginError>(
        [=] { call_plugin("keep_low", "evaluate", [=]() -> int { throw thrown; }); });
  };
  EXPECT_EQ(from(std::runtime_error("no")),
            "plugin 'keep_low' failed in evaluate: no; try it alone: lapwing plugins check "
            "keep_low");
  EXPECT_EQ(from(3),
            "plugin 'keep_low' failed in evaluate: an exception of unknown type; try it "
            "alone: lapwing plugins check keep_low");
  // Out of memory is no fault of the plugin: nothing to try alone.
  const std::string scarce = from(std::bad_alloc());
  EXPECT_NE(scarce.find("out of memory"), std::string::npos) << scarce;
  EXPECT_EQ(scarce.find("try it alone"), std::string::npos) << scarce;
  // A defect of the kernel that a plugin runs into counts as the plugin's.
  EXPECT_NE(from(Error("a defect")).find("failed in evaluate: a defect"), std::string::npos);
}

TEST(PluginErrors, LeaveOthersAlone) {
  EXPECT_EQ(
      message_of<InputError>([] { call_plugin("a", "b", [] { throw InputError("the user's"); }); }),
      "the user's");
  // The innermost plugin is the one that failed.
  EXPECT_EQ(message_of<PluginError>([] {
              call_plugin("outer", "solve", [] {
                call_plugin("inner", "evaluate", [] { throw std::runtime_error("no"); });
              });
            }).substr(0, 42),
            "plugin 'inner' failed in evaluate: no; try");
  EXPECT_EQ(message_of<Cancelled>([] { call_plugin("a", "b", [] { throw Cancelled(); }); }),
            "cancelled");
  EXPECT_EQ(call_plugin("a", "b", [] { return 7; }), 7);
  int place = 0;
  EXPECT_EQ(&call_plugin("a", "b", [&]() -> int& { return place; }), &place) << "not a copy";
}

}  // namespace
}  // namespace lapwing
