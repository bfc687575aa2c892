// SPDX-License-Identifier: Apache-2.0
// Times of keyframes against every choice there is, and against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "framework/core/error.h"
#include "framework/trajectory/keyframe_timing.h"

namespace lapwing {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// What the times cost, written from the statement of the problem: infinite where not allowed.
double cost_of(const std::vector<TimeWish>& wishes, const std::vector<double>& legs,
               const std::vector<double>& times) {
  double cost = times.back();
  for (std::size_t k = 0; k < times.size(); ++k) {
    const TimeWish& wish = wishes[k];
    if (k > 0 && times[k] - times[k - 1] < legs[k - 1] - 1e-8) return kNever;
    if (wish.time_weight)
      cost += *wish.time_weight * std::pow(times[k] - *wish.time, 2);
    else if (wish.time && std::abs(times[k] - *wish.time) > 1e-8)
      return kNever;
    else if (times[k] < wish.earliest.value_or(0) - 1e-8 ||
             times[k] > wish.latest.value_or(kNever) + 1e-8)
      return kNever;
  }
  return cost;
}

// The least cost over all choices of times of a grid of 0.05 s and the named ones.
double brute_force(const std::vector<TimeWish>& wishes, const std::vector<double>& legs,
                   double end) {
  std::vector<double> grid;
  for (int i = 0; i * 0.05 <= end; ++i) grid.push_back(i * 0.05);
  for (const TimeWish& wish : wishes)
    for (const auto& named : {wish.time, wish.earliest, wish.latest})
      if (named) grid.push_back(*named);
  double least = kNever;
  std::vector<double> times(wishes.size(), 0.0);
  const auto choose = [&](const auto& self, std::size_t k) -> void {
    if (k == wishes.size()) {
      least = std::min(least, cost_of(wishes, legs, times));
      return;
    }
    for (const double time : grid) {
      if (time < times[k - 1] + legs[k - 1] - 1e-8) continue;
      times[k] = time;
      self(self, k + 1);
    }
  };
  choose(choose, 1);
  return least;
}

TEST(KeyframeTiming, NoChoiceIsCheaper) {
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  int granted = 0, refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<TimeWish> wishes(4);
    std::vector<double> legs;
    for (std::size_t k = 1; k < wishes.size(); ++k) {
      legs.push_back(uniform(0.05, 0.6));
      const int kind = static_cast<int>(uniform(0, 5));
      if (kind == 0) wishes[k].time = uniform(0.1, 1.8);
      if (kind == 1) wishes[k] = {uniform(0.1, 1.8), uniform(0.1, 20), {}, {}};
      if (kind == 2) wishes[k].earliest = uniform(0.1, 1.8);
      if (kind == 3) wishes[k].latest = uniform(0.3, 1.8);
    }
    const KeyframeTimes found = cheapest_times(wishes, legs);
    const double least = brute_force(wishes, legs, 3.7);
    if (found.refused) {
      ++refused;
      EXPECT_EQ(least, kNever) << round;
      EXPECT_TRUE(found.times.empty());
      continue;
    }
    ++granted;
    ASSERT_EQ(found.times.size(), wishes.size());
    EXPECT_EQ(found.times[0], 0);
    const double cost = cost_of(wishes, legs, found.times);
    EXPECT_LE(cost, least + 1e-7) << round;
    // The problem is convex: no neighbouring keyframes can be moved together to a lower cost.
    for (std::size_t first = 1; first < wishes.size(); ++first)
      for (std::size_t last = first; last < wishes.size(); ++last)
        for (const double by : {-1e-4, 1e-4}) {
          std::vector<double> moved = found.times;
          for (std::size_t k = first; k <= last; ++k) moved[k] += by;
          EXPECT_GE(cost_of(wishes, legs, moved), cost - 1e-12) << round;
        }
  }
  EXPECT_GT(granted, 100);
  EXPECT_GT(refused, 20);
}

TEST(KeyframeTiming, PreferredTimesAreWeighedAgainstTheDuration) {
  // t + leg + w (t - a)^2 is least at t = a - 1 / (2 w).
  for (const double weight : {0.5, 2.0, 8.0}) {
    const std::vector<TimeWish> wishes = {{}, {4.0, weight, {}, {}}, {}};
    const KeyframeTimes found = cheapest_times(wishes, std::vector<double>{1.0, 2.0});
    ASSERT_FALSE(found.refused);
    EXPECT_NEAR(found.times[1], 4.0 - 0.5 / weight, 1e-12) << weight;
    EXPECT_NEAR(found.times[2], found.times[1] + 2, 1e-9);
  }
}

TEST(KeyframeTiming, WithoutWishesEveryLegIsAsShortAsItMayBe) {
  const std::vector<double> legs = {1.234, 0.777, 3.001};
  const KeyframeTimes found = cheapest_times(std::vector<TimeWish>(4), legs);
  ASSERT_EQ(found.times.size(), 4u);
  for (std::size_t k = 1; k < 4; ++k)
    EXPECT_NEAR(found.times[k] - found.times[k - 1], legs[k - 1], 1e-12);
  EXPECT_EQ(cheapest_times(std::vector<TimeWish>(1), {}).times, std::vector<double>{0});
}

TEST(KeyframeTiming, TheKeyframeThatCannotBeGrantedIsNamed) {
  const auto refused = [](std::vector<TimeWish> wishes, std::vector<double> legs) {
    return cheapest_times(wishes, legs).refused;
  };
  EXPECT_EQ(refused({{}, {3.0, {}, {}, {}}, {3.5, {}, {}, {}}}, {1, 1}), 2u);
  EXPECT_EQ(refused({{}, {{}, {}, {}, 0.5}, {}}, {1, 1}), 1u);
  EXPECT_EQ(refused({{{}, {}, 1.0, {}}}, {}), 0u) << "the first is passed at 0 s";
  EXPECT_FALSE(refused({{}, {3.0, {}, {}, {}}, {4.0, {}, {}, {}}}, {1, 1}));
}

TEST(KeyframeTiming, PreferredTimesThatAreTooCloseShareTheirErrors) {
  // t1 = 3 and t2 = 3.5 are preferred 2 s apart, with weights 1 and 3, and the film goes on for 1
  // s: 1 + 2 (t1 - 3) + 6 (t1 + 2 - 3.5) = 0.
  const std::vector<TimeWish> wishes = {{}, {3.0, 1.0, {}, {}}, {3.5, 3.0, {}, {}}, {}};
  const KeyframeTimes found = cheapest_times(wishes, std::vector<double>{1.0, 2.0, 1.0});
  ASSERT_FALSE(found.refused);
  const double first = (6.0 + 9.0 - 1.0) / 8.0;
  EXPECT_NEAR(found.times[1], first, 1e-12);
  EXPECT_NEAR(found.times[2], first + 2, 1e-12);
  EXPECT_NEAR(found.times[3], first + 3, 1e-12);
}

TEST(KeyframeTiming, LongListsTakeLittleTime) {
  const std::vector<TimeWish> wishes = {{}, {5e5, {}, {}, {}}, {{}, {}, 6e5, {}}};
  const KeyframeTimes found = cheapest_times(wishes, std::vector<double>{10, 10});
  EXPECT_EQ(found.times, (std::vector<double>{0, 5e5, 6e5}));
  // Preferred in falling order, so that all of them are pooled.
  std::vector<TimeWish> many(100'000);
  for (std::size_t k = 1; k < many.size(); ++k)
    many[k] = {2.0 * static_cast<double>(many.size() - k), 1.0, {}, {}};
  const std::vector<double> legs(many.size() - 1, 1.0);
  const KeyframeTimes pooled = cheapest_times(many, legs);
  ASSERT_EQ(pooled.times.size(), many.size());
  for (std::size_t k = 2; k < many.size(); k += 997)
    EXPECT_NEAR(pooled.times[k] - pooled.times[k - 1], 1.0, 1e-6);
  EXPECT_THROW(cheapest_times(wishes, std::vector<double>{1}), Error);
}

TEST(KeyframeTiming, StopsFollowThePathInOrder) {
  Points path;
  for (int i = 0; i <= 100; ++i) path.emplace_back(i <= 50 ? i : 100 - i, 0, 0);  // there and back
  const std::vector<std::size_t> stops =
      keyframe_stops(path, {{0, 0, 0}, {20, 1, 0}, {49, 0, 0}, {20, 0, 3}, {0, 0, 0}});
  EXPECT_EQ(stops, (std::vector<std::size_t>{0, 20, 49, 80, 100}));
  EXPECT_THROW(keyframe_stops({}, {{0, 0, 0}}), Error);
}

}  // namespace
}  // namespace lapwing
