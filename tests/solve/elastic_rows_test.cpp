// SPDX-License-Identifier: Apache-2.0
// What p and q of elastic rows are at their start, and their step, against the equations that they
// are eliminated from.
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "framework/solve/elastic_rows.h"
#include "tests/solve/programs.h"

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kPrice = 7, kBarrier = 0.3;
const std::vector<RowKind> kRows = {RowKind::equation, RowKind::inequality, RowKind::unbounded,
                                    RowKind::equation};
const int kElastic[] = {0, 1, 3};

// p and q of every row, and their multipliers.
std::vector<std::pair<double, double>> pairs_of(ElasticRows& rows) {
  std::vector<std::pair<double, double>> pairs;
  rows.keep([&](double& z, double& number) { pairs.emplace_back(number, z); });
  return pairs;
}

ElasticRows begun(const VectorXd& away) {
  ElasticRows rows;
  rows.begin(kRows, away, kPrice, kBarrier);
  return rows;
}

TEST(ElasticRows, BeginAtTheMinimumOfTheBarrier) {
  const VectorXd away = numbers({0.5, -3, 9, 0});
  ElasticRows rows = begun(away);
  ASSERT_TRUE(rows.active());
  EXPECT_EQ(rows.penalty(), kPrice);
  const auto pairs = pairs_of(rows);
  for (const int r : kElastic) {
    const auto [p, z_p] = pairs[2 * r];
    const auto [q, z_q] = pairs[2 * r + 1];
    EXPECT_GT(p, 0);
    EXPECT_GT(q, 0);
    EXPECT_NEAR(rows.miss(r), away(r), 1e-12) << "they make up for what is missing";
    // Of price (p + q) - barrier (log p + log q) along the line where p - q is that.
    EXPECT_NEAR(kBarrier / p + kBarrier / q, 2 * kPrice, 1e-9);
    EXPECT_NEAR(p * z_p, kBarrier, 1e-12);
    EXPECT_NEAR(q * z_q, kBarrier, 1e-12);
  }
  EXPECT_NEAR(rows.deviation(kBarrier), 0, 1e-12);
  EXPECT_NEAR(rows.deviation(kBarrier / 2), kBarrier / 2, 1e-12);
  EXPECT_EQ(pairs[4], (std::pair<double, double>(1, 1))) << "the row without bounds";
  rows.end();
  EXPECT_FALSE(rows.active());
  EXPECT_EQ(rows.penalty(), kPrice);
}

TEST(ElasticRows, HugeViolationsStayFinite) {
  for (const double away : {1e16, -1e16, 1e300, -1e300}) {
    ElasticRows rows = begun(VectorXd::Constant(4, away));
    for (const auto& [number, multiplier] : pairs_of(rows)) {
      EXPECT_GT(number, 0) << away;
      EXPECT_TRUE(std::isfinite(multiplier)) << away;
    }
  }
}

// The step solves Newton's equations of p z_p = mu, q z_q = mu, z_p = price - y, z_q = price + y,
// with the new row: p - q changes by aim and relief.
TEST(ElasticRows, StepsSolveTheEquationsThatTheyAreEliminatedFrom) {
  ElasticRows rows = begun(numbers({0.5, -3, 9, 0}));
  const VectorXd y = numbers({1.5, -2, 0, 4}), dy = numbers({0.3, 0.7, 0, -0.2});
  const double barrier = 0.1;
  VectorXd aims = VectorXd::Zero(4);
  for (const int r : kElastic) aims(r) = rows.aim(r, y(r), barrier);
  rows.follow(y, dy);
  const auto before = pairs_of(rows);
  ElasticRows moved = rows;
  moved.take(1, 1);
  const auto after = pairs_of(moved);
  for (const int r : kElastic) {
    for (const int side : {0, 1}) {
      const auto [number, z] = before[2 * r + side];
      const auto [next, next_z] = after[2 * r + side];
      EXPECT_NEAR(number * z + z * (next - number) + number * (next_z - z), barrier, 1e-12);
      EXPECT_NEAR(next_z, kPrice + (side ? 1 : -1) * (y(r) + dy(r)), 1e-12);
    }
    EXPECT_NEAR(rows.change_of_miss(r), -aims(r) + rows.relief(r) * dy(r), 1e-12);
    EXPECT_NEAR(moved.miss(r), rows.miss(r) + rows.change_of_miss(r), 1e-12);
  }
  EXPECT_EQ(after[4], before[4]);
}

TEST(ElasticRows, SlopeIsTheDerivativeOfTheCost) {
  ElasticRows rows = begun(numbers({0.5, -3, 9, 0}));
  for (const int r : kElastic) rows.aim(r, 1.0 - r, 0.05);
  rows.follow(numbers({1, 0, 0, -2}), numbers({0.3, 0.7, 0, -0.2}));
  const auto cost = [&](double alpha) {
    double logarithms = 0, sum = 0;
    rows.add_cost(alpha, logarithms, sum);
    return kPrice * sum - 0.05 * logarithms;
  };
  double slope = 1;
  rows.add_slope(0.05, slope);
  EXPECT_NEAR(slope - 1, (cost(1e-6) - cost(-1e-6)) / 2e-6, 1e-5 * (1 + std::abs(slope)));
}

// The longest step leaves exactly 1 - share of the number that shrinks fastest.
TEST(ElasticRows, StepsKeepNumbersPositive) {
  ElasticRows rows = begun(numbers({0.5, -3, 9, 0}));
  const VectorXd down = numbers({-1, -1, -1e9, -1});
  rows.set_steps({down, VectorXd::Zero(4)});
  double alpha = 1;
  rows.limit(false, 0.9, alpha);
  ASSERT_LT(alpha, 1);
  const auto before = pairs_of(rows);
  rows.take(alpha, 0);
  double least = 1;
  const auto after = pairs_of(rows);
  for (const int r : kElastic) least = std::min(least, after[2 * r].first / before[2 * r].first);
  EXPECT_NEAR(least, 0.1, 1e-12) << "a row without bounds limits nothing";
  double free = 1;
  rows.limit(true, 0.9, free);
  EXPECT_EQ(free, 1) << "multipliers stand still";
}

}  // namespace
}  // namespace lapwing
