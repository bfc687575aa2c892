// SPDX-License-Identifier: Apache-2.0
#include "framework/core/log.h"

#include <thread>

namespace lapwing {
namespace {

TEST(Log, CapturesEveryLevelWithoutTheTime) {
  logging::set_console_level(logging::Level::off);
  logging::Capture capture;
  logging::debug("one {}");
  logging::info("two");
  logging::warning("three");
  logging::error("four");
  EXPECT_EQ(capture.text(), "debug: one {}\ninfo: two\nwarning: three\nerror: four\n");
  {
    const logging::Capture inner;
    logging::info("five");
    EXPECT_EQ(inner.text(), "info: five\n");
  }
  logging::info("six");
  EXPECT_NE(capture.text().find("five\ninfo: six\n"), std::string::npos);
  logging::set_console_level(logging::Level::warning);
}

TEST(Log, ShowsWarningsOnTheConsoleAndDebugOnRequest) {
  testing::internal::CaptureStderr();
  logging::info("not shown");
  logging::warning("shown");
  logging::set_console_level(logging::Level::debug);
  logging::debug("shown too");
  logging::set_console_level(logging::Level::warning);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: shown\ndebug: shown too\n");
}

TEST(Log, LinesOfManyThreadsStayWhole) {
  logging::Capture capture;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([] {
      for (int i = 0; i < 250; ++i) logging::info("abcdefghij");
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::string expected;
  for (int i = 0; i < 1000; ++i) expected += "info: abcdefghij\n";
  EXPECT_EQ(capture.text(), expected);
}

}  // namespace
}  // namespace lapwing
