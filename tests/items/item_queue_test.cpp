// SPDX-License-Identifier: Apache-2.0
// The order of items, and schedules against makespans that are known.
#include "framework/items/item_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "framework/core/random.h"
#include "framework/items/item_schedule.h"

namespace lapwing {
namespace {

std::vector<Item> items_in(const std::vector<std::size_t>& groups) {
  std::vector<Item> items;
  for (std::size_t i = 0; i < groups.size(); ++i)
    items.push_back({"item_" + std::to_string(i), groups[i], {}});
  return items;
}

std::vector<std::size_t> all_of(const std::vector<Item>& items) {
  std::vector<std::size_t> all(items.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

std::vector<std::size_t> taken(ItemQueue& queue) {
  std::vector<std::size_t> order;
  while (const auto item = queue.take(0, {})) order.push_back(*item);
  return order;
}

TEST(ItemQueue, HandsOutTheLongestFirst) {
  const auto items = items_in({0, 0, 0, 0, 0});
  ItemQueue queue(items, all_of(items), {1, 5, 3, 5, 2});
  EXPECT_EQ(queue.left(), 5u);
  EXPECT_THAT(taken(queue), testing::ElementsAre(1, 3, 2, 4, 0));
  EXPECT_EQ(queue.left(), 0u);
  ItemQueue some(items, {4, 0}, {1, 5, 3, 5, 2});
  EXPECT_THAT(taken(some), testing::ElementsAre(4, 0));
}

TEST(ItemQueue, AProcessKeepsToItsGroupUnlessAnItemIsTwiceAsLong) {
  const auto items = items_in({0, 0, 1, 1});
  ItemQueue queue(items, all_of(items), {6, 6, 10, 10});
  EXPECT_EQ(queue.take(0, {0}), 0u);  // 6 s is more than half of 10 s
  EXPECT_EQ(queue.take(0, {}), 2u);
  ItemQueue long_ones(items, all_of(items), {4, 4, 10, 10});
  EXPECT_EQ(long_ones.take(0, {0}), 2u);  // 4 s is less
}

TEST(ItemQueue, ProcessesBeginGroupsThatNoOtherHas) {
  const auto items = items_in({0, 0, 1, 1, 2, 2});
  ItemQueue queue(items, all_of(items), std::vector<double>(6, 1));
  EXPECT_EQ(queue.take(0, {}), 0u);
  EXPECT_EQ(queue.take(1, {}), 2u);
  EXPECT_EQ(queue.take(2, {}), 4u);
  EXPECT_EQ(queue.take(1, {1}), 3u);
  EXPECT_EQ(queue.take(1, {1}), 1u);  // its group is at its end: it helps another process
  EXPECT_EQ(queue.take(0, {0}), 5u);
  EXPECT_EQ(queue.take(0, {0}), std::nullopt);
}

TEST(ItemQueue, NothingIsLeftOnceItIsClosed) {
  const auto items = items_in({0, 1});
  ItemQueue queue(items, all_of(items), {1, 1});
  queue.close();
  EXPECT_EQ(queue.left(), 0u);
  EXPECT_EQ(queue.take(0, {}), std::nullopt);
}

TEST(ItemSchedule, OfOneProcessIsTheSum) {
  const auto items = items_in({0, 0, 0});
  const Schedule one = simulate_schedule({items, all_of(items), {3, 1, 2}, {4}}, 1, 1);
  EXPECT_NEAR(one.seconds, 10, 1e-9);  // the group is prepared once
  EXPECT_NEAR(one.busy, 0.6, 1e-9);
}

// Four items of 3, 3, 2 and 2 s on two processes: 5 s each, and a few ms of dispatch.
TEST(ItemSchedule, OfTwoProcessesIsTheBestOne) {
  const auto items = items_in({0, 0, 0, 0});
  const ScheduleInput input{items, all_of(items), {2, 3, 2, 3}, {0}};
  const Schedule two = simulate_schedule(input, 2, 1);
  EXPECT_GE(two.seconds, 5);
  EXPECT_LE(two.seconds, 5.01);
  EXPECT_NEAR(two.busy, 1, 0.01);
  EXPECT_NEAR(simulate_schedule(input, 1, 2).seconds, 5, 1e-9);
  // The longest item bounds every schedule.
  EXPECT_NEAR(simulate_schedule(input, 1000, 1).seconds, 3, 0.01);
  EXPECT_EQ(enough_ranks(input, 1000, 1), 4);  // of three, one has 2 + 2 s
}

// Longest first is at most a third longer than any schedule (Graham 1969), which takes at least the
// mean load and the longest item.
TEST(ItemSchedule, KeepsGrahamsBound) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const auto items = items_in(std::vector<std::size_t>(200, 0));
    std::vector<double> seconds;
    for (std::size_t i = 0; i < items.size(); ++i) seconds.push_back(random.uniform(1, 50));
    const int ranks = static_cast<int>(random.integer(1, 40));
    const Schedule schedule = simulate_schedule({items, all_of(items), seconds, {0}}, ranks, 1);
    const double bound = std::max(std::accumulate(seconds.begin(), seconds.end(), 0.0) / ranks,
                                  *std::max_element(seconds.begin(), seconds.end()));
    EXPECT_GE(schedule.seconds, bound - 1e-9);
    EXPECT_LE(schedule.seconds, 4.0 / 3 * bound + 0.1) << ranks;
  }
}

}  // namespace
}  // namespace lapwing
