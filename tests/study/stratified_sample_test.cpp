// SPDX-License-Identifier: Apache-2.0
#include "framework/study/stratified_sample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace lapwing {
namespace {

StratifiedSample sample_of(std::initializer_list<double> values) {
  StratifiedSample sample;
  for (const double value : values) sample.add(value);
  return sample;
}

TEST(StratifiedSample, OfOneGroupIsAnOrdinaryOne) {
  const StratifiedSample sample = sample_of({2, 4, 4, 4, 5, 5, 7, 9});
  EXPECT_EQ(sample.count(), 8u);
  EXPECT_DOUBLE_EQ(sample.mean(), 5);
  EXPECT_DOUBLE_EQ(sample.deviation(), std::sqrt(32.0 / 7));
  EXPECT_NEAR(sample.interval(), 2.364624251592785 * std::sqrt(32.0 / 7 / 8), 1e-12);
}

// Groups far apart whose values agree leave nothing open; the deviation is that of all values.
TEST(StratifiedSample, GroupsAreNoChance) {
  StratifiedSample all;
  all.join(sample_of({1, 1, 1}));
  all.join(sample_of({9, 9, 9}));
  EXPECT_DOUBLE_EQ(all.mean(), 5);
  EXPECT_DOUBLE_EQ(all.interval(), 0);
  EXPECT_DOUBLE_EQ(all.deviation(), std::sqrt(96.0 / 5));
  // Of unequal size: weights 1/3 and 2/3, variances 2 and 4/3 of the groups.
  StratifiedSample two;
  two.join(sample_of({0, 2}));
  two.join(sample_of({5, 7, 5, 7}));
  EXPECT_DOUBLE_EQ(two.mean(), 26.0 / 6);
  EXPECT_NEAR(two.interval(),
              2.776445105197793 * std::sqrt(2.0 / 9 / 2 * 1 + 4.0 / 9 * (4.0 / 3) / 4), 1e-12);
}

// As tables of the distribution have them.
TEST(StratifiedSample, TheIntervalIsStudents) {
  for (const auto& [freedom, quantile] : {std::pair{1, 12.7062},
                                          {2, 4.3027},
                                          {30, 2.0423},
                                          {31, 2.0395},
                                          {40, 2.0211},
                                          {60, 2.0003},
                                          {120, 1.9799}}) {
    StratifiedSample sample;
    for (int k = 0; k <= freedom; ++k) sample.add(k % 2);
    const double error = sample.deviation() / std::sqrt(freedom + 1.0);
    EXPECT_NEAR(sample.interval() / error, quantile, 6e-5) << freedom;
  }
}

TEST(StratifiedSample, TooFewValuesAreNoFigure) {
  EXPECT_TRUE(std::isnan(StratifiedSample().mean()));
  EXPECT_TRUE(std::isnan(StratifiedSample().deviation()));
  EXPECT_TRUE(std::isnan(StratifiedSample().interval()));
  EXPECT_TRUE(std::isnan(sample_of({3}).deviation()));
  EXPECT_TRUE(std::isnan(sample_of({3}).interval()));
  StratifiedSample mixed = sample_of({1, 2});
  mixed.join(sample_of({3}));
  mixed.join(StratifiedSample());
  EXPECT_EQ(mixed.count(), 3u);
  EXPECT_TRUE(std::isnan(mixed.interval()));
}

}  // namespace
}  // namespace lapwing
