// SPDX-License-Identifier: Apache-2.0
#include "framework/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>
#include <vector>

#include "framework/core/error.h"

namespace lapwing {
namespace {

TEST(Parallel, EveryIndexIsCalledOnce) {
  for (const int threads : {-1, 0, 1, 2, 5}) {
    for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, threads, [&](std::size_t i) { ++calls[i]; });
      for (const auto& c : calls) EXPECT_EQ(c, 1) << threads << " threads, " << count;
    }
  }
  EXPECT_GE(available_threads(), 1);
}

TEST(Parallel, OneThreadRunsInOrderOnTheCaller) {
  std::vector<std::size_t> order;
  std::set<std::thread::id> threads;
  parallel_for(100, 1, [&](std::size_t i) {
    order.push_back(i);
    threads.insert(std::this_thread::get_id());
  });
  ASSERT_EQ(order.size(), 100u);
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(Parallel, AnExceptionReachesTheCaller) {
  for (const int threads : {1, 2}) {
    const auto fail = [](std::size_t i) {
      if (i == 37) throw InputError("thirty-seven");
    };
    try {
      parallel_for(100, threads, fail);
      FAIL() << "nothing was thrown";
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "thirty-seven");
    }
  }
}

TEST(Parallel, LoopsNest) {
  std::vector<int> cells(64, 0);
  parallel_for(8, 2, [&](std::size_t i) {
    parallel_for(8, 2, [&](std::size_t k) { cells[8 * i + k] = static_cast<int>(8 * i + k); });
  });
  for (int i = 0; i < 64; ++i) EXPECT_EQ(cells[static_cast<std::size_t>(i)], i);
}

}  // namespace
}  // namespace lapwing
