// SPDX-License-Identifier: Apache-2.0
#include "framework/core/own_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <thread>
#include <vector>

#include "framework/core/error.h"

namespace lapwing {
namespace {

std::string refusal(const std::function<std::string()>& work, ProcessLimits limits = {}) {
  try {
    in_own_process("reading 'x'", limits, work);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OwnProcess, ReturnsWhatTheWorkReturns) {
  EXPECT_EQ(in_own_process("x", {}, [] { return std::string(); }), "");
  const std::string large(10'000'000, 'z');
  EXPECT_TRUE(in_own_process("x", {}, [&] { return large; }) == large);
  int changed = 1;
  EXPECT_EQ(in_own_process("x", {}, [&] { return std::to_string(++changed); }), "2");
  EXPECT_EQ(changed, 1);
}

TEST(OwnProcess, ACrashIsAnError) {
  EXPECT_EQ(refusal([]() -> std::string {
              std::raise(SIGSEGV);
              return "";
            }),
            "reading 'x': reading it crashed (Segmentation fault)");
  EXPECT_NE(refusal([]() -> std::string { std::abort(); }).find("Aborted"), std::string::npos);
  EXPECT_NE(refusal([]() -> std::string { ::_exit(3); }).find("without an answer"),
            std::string::npos);
}

TEST(OwnProcess, ErrorsKeepTheirText) {
  EXPECT_EQ(refusal([]() -> std::string { throw InputError("line 3: no"); }), "line 3: no");
  EXPECT_EQ(refusal([]() -> std::string { throw std::runtime_error("why"); }), "reading 'x': why");
}

TEST(OwnProcess, LimitsHold) {
  EXPECT_EQ(refusal(
                []() -> std::string {
                  for (;;) ::pause();
                },
                {.seconds = 0.2}),
            "reading 'x': it takes longer than 0.2 s");
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_EQ(refusal([] { return std::string(std::size_t{1} << 34, 'm'); }, {.memory = 1e8}),
            "reading 'x': it takes too much memory");
#endif
}

TEST(OwnProcess, SeveralAtOnce) {
  std::vector<std::string> results(8);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < results.size(); ++i) {
    threads.emplace_back(
        [&results, i] { results[i] = in_own_process("x", {}, [i] { return std::to_string(i); }); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < results.size(); ++i) EXPECT_EQ(results[i], std::to_string(i));
}

}  // namespace
}  // namespace lapwing
