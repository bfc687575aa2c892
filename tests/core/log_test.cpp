#include "framework/core/log.h"

#include <thread>

namespace lapwing {
namespace {

TEST(Log, CapturesEveryLevelWithoutTheTime) {
  log::set_console_level(log::Level::off);
  log::Capture capture;
  log::debug("one {}");
  log::info("two");
  log::warning("three");
  log::error("four");
  EXPECT_EQ(capture.text(), "debug: one {}\ninfo: two\nwarning: three\nerror: four\n");
  {
    const log::Capture inner;
    log::info("five");
    EXPECT_EQ(inner.text(), "info: five\n");
  }
  log::info("six");
  EXPECT_NE(capture.text().find("five\ninfo: six\n"), std::string::npos);
  log::set_console_level(log::Level::warning);
}

TEST(Log, ShowsWarningsOnTheConsoleAndDebugOnRequest) {
  testing::internal::CaptureStderr();
  log::info("not shown");
  log::warning("shown");
  log::set_console_level(log::Level::debug);
  log::debug("shown too");
  log::set_console_level(log::Level::warning);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: shown\ndebug: shown too\n");
}

TEST(Log, LinesOfManyThreadsStayWhole) {
  log::Capture capture;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([] {
      for (int i = 0; i < 250; ++i) log::info("abcdefghij");
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::string expected;
  for (int i = 0; i < 1000; ++i) expected += "info: abcdefghij\n";
  EXPECT_EQ(capture.text(), expected);
}

}  // namespace
}  // namespace lapwing
