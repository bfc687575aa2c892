// SPDX-License-Identifier: Apache-2.0
// Programs like ones solved before: by their active bounds, against the interior point.
#include <gtest/gtest.h>

#include "framework/solve/active_set.h"
#include "tests/solve/programs.h"

namespace lapwing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Twelve variables in boxes, three equations, five rows between bounds; some of all hold.
QuadraticProgram random_program(Random& random) {
  const int n = 12, equations = 3, rows = 8;
  const MatrixXd root = normal_matrix(n, n, random);
  const VectorXd inside = 0.3 * normal_vector(n, random);
  const MatrixXd a = normal_matrix(rows, n, random);
  VectorXd low = a * inside, high = low;
  for (int r = equations; r < rows; ++r) low(r) -= 0.5, high(r) += 0.5;
  return dense_program(root * root.transpose() + 0.1 * MatrixXd::Identity(n, n),
                       8.0 * normal_vector(n, random), a, low, high, VectorXd::Constant(n, -1),
                       VectorXd::Constant(n, 1));
}

QuadraticWarmStart start_at(const QuadraticResult& found) {
  return {found.x, found.row_multipliers, found.bound_multipliers};
}

// x^2 + y^2 - 6 x - 2 y with x + y <= 3 and x <= 2: x = 2, y = 1, where the row begins to hold.
TEST(ActiveSet, GivesTheKnownAnswer) {
  const auto program = [](double along_y, double sum) {
    return dense_program(2 * MatrixXd::Identity(2, 2), numbers({-6, along_y}), MatrixXd::Ones(1, 2),
                         numbers({-kOpen}), numbers({sum}), numbers({-kOpen, -kOpen}),
                         numbers({2, kOpen}));
  };
  ActiveSet sets;
  const QuadraticWarmStart at_zero{VectorXd::Zero(2), VectorXd::Zero(1), VectorXd::Zero(2)};
  const auto found = sets.solve(program(-2, 3.5), {}, at_zero);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->status, QuadraticStatus::optimal);
  EXPECT_NEAR((found->x - numbers({2, 1})).norm(), 0, 1e-8);
  EXPECT_NEAR(found->bound_multipliers(0), -2, 1e-8) << "x would go on to 3";
  EXPECT_NEAR(found->row_multipliers(0), 0, 1e-8);
  // The row takes over from nothing, and then from the bound.
  const auto both = sets.solve(program(-4, 3.5), {}, start_at(*found));
  ASSERT_TRUE(both);
  EXPECT_NEAR((both->x - numbers({2, 1.5})).norm(), 0, 1e-8);
  EXPECT_NEAR(both->row_multipliers(0), -1, 1e-8);
  const auto row = sets.solve(program(-4, 1), {}, start_at(*both));
  ASSERT_TRUE(row);
  EXPECT_NEAR((row->x - numbers({1, 0})).norm(), 0, 1e-8);
  EXPECT_NEAR(row->row_multipliers(0), -4, 1e-8);
  EXPECT_NEAR(row->bound_multipliers(0), 0, 1e-8);
}

TEST(ActiveSet, AnswersAsTheInteriorPointDoes) {
  Random random(3);
  InteriorPoint interior_point;
  ActiveSet sets;
  int answered = 0, held = 0;
  for (int round = 0; round < 200; ++round) {
    QuadraticProgram program = random_program(random);
    const QuadraticResult before = interior_point.solve(program);
    ASSERT_EQ(before.status, QuadraticStatus::optimal) << round;
    program.gradient += 0.2 * normal_vector(program.variables(), random);
    const QuadraticResult wanted = interior_point.solve(program);
    ASSERT_EQ(wanted.status, QuadraticStatus::optimal) << round;
    const auto found = sets.solve(program, {}, start_at(before));
    if (!found) continue;
    ++answered;
    held += (found->bound_multipliers.array() != 0).any();
    // As near as the gap of 1e-9 that the interior point leaves.
    const double cost = program.objective(found->x);
    EXPECT_NEAR(cost, program.objective(wanted.x), 2e-9 * (1 + std::abs(cost))) << round;
    EXPECT_NEAR((found->x - wanted.x).norm(), 0, 1e-4) << round;
    EXPECT_TRUE(residuals(program, found->x, found->row_multipliers, found->bound_multipliers)
                    .within(1e-9));
    EXPECT_LE(found->iterations, 6);
  }
  EXPECT_GT(answered, 160);
  EXPECT_GT(held, 100);
}

// Bounds that all pushed before cannot all be met once the sum is smaller: those that must are let
// go.
TEST(ActiveSet, LetsGoOfBoundsThatCannotAllBeMet) {
  const auto program = [](double sum) {
    return dense_program(2 * MatrixXd::Identity(3, 3), numbers({-10, -9, -8}), MatrixXd::Ones(1, 3),
                         numbers({sum}), numbers({sum}), numbers({-1, -1, -1}), numbers({1, 1, 1}));
  };
  const QuadraticWarmStart all_held{numbers({1, 1, 1}), numbers({0}), numbers({-8, -7, -6})};
  ActiveSet sets;
  const auto found = sets.solve(program(2.5), {}, all_held);
  ASSERT_TRUE(found);
  EXPECT_NEAR((found->x - numbers({1, 1, 0.5})).norm(), 0, 1e-8);
  EXPECT_NEAR(found->row_multipliers(0), -7, 1e-7) << "2 x - 8 of the one that is free";
  EXPECT_NEAR(found->bound_multipliers(0), -1, 1e-7);
  EXPECT_FALSE(sets.solve(program(3.5), {}, all_held)) << "more than the bounds allow";
}

// The same at random: equations move by more than the variables that are free can follow.
TEST(ActiveSet, AnswersWhereEquationsMove) {
  Random random(8);
  InteriorPoint interior_point;
  ActiveSet sets;
  int possible = 0, answered = 0;
  for (int round = 0; round < 200; ++round) {
    QuadraticProgram program = random_program(random);
    program.gradient *= 10;  // most variables are held
    const QuadraticResult before = interior_point.solve(program);
    if (before.status != QuadraticStatus::optimal) continue;
    for (int r = 0; r < 3; ++r)
      program.row_lower(r) = program.row_upper(r) = program.row_lower(r) + 0.2 * random.normal();
    const QuadraticResult wanted = interior_point.solve(program);
    if (wanted.status != QuadraticStatus::optimal) continue;
    ++possible;
    const auto found = sets.solve(program, {}, start_at(before));
    if (!found) continue;
    ++answered;
    EXPECT_NEAR(program.objective(found->x), program.objective(wanted.x),
                1e-8 * (1 + std::abs(program.objective(wanted.x))))
        << round;
    EXPECT_TRUE(residuals(program, found->x, found->row_multipliers, found->bound_multipliers)
                    .within(1e-9));
  }
  EXPECT_GT(possible, 150);
  EXPECT_GT(answered, 0.8 * possible) << possible;
}

// The first point is drawn at once, unless it breaks bounds that were not taken yet.
TEST(ActiveSet, GivesAnEarlyPointOnlyWithinItsBounds) {
  const auto program = [](double along_x) {
    return dense_program(2 * MatrixXd::Identity(2, 2), numbers({along_x, -2}), MatrixXd::Ones(1, 2),
                         numbers({-kOpen}), numbers({kOpen}), numbers({-kOpen, -kOpen}),
                         numbers({2, kOpen}));
  };
  ActiveSet sets;
  std::vector<VectorXd> early;
  const InteriorPointOptions options{.early = [&](const VectorXd& x) { early.push_back(x); }};
  const QuadraticWarmStart at_zero{VectorXd::Zero(2), VectorXd::Zero(1), VectorXd::Zero(2)};
  ASSERT_TRUE(sets.solve(program(-3), options, at_zero));
  ASSERT_EQ(early.size(), 1u);
  EXPECT_NEAR((early[0] - numbers({1.5, 1})).norm(), 0, 1e-8);
  const auto held = sets.solve(program(-6), options, at_zero);  // first at x = 3, then at 2
  ASSERT_TRUE(held);
  EXPECT_EQ(held->iterations, 2);
  EXPECT_EQ(early.size(), 1u);
}

TEST(ActiveSet, SaysNothingWhereItCannotKnow) {
  Random random(4);
  ActiveSet sets;
  QuadraticProgram program = random_program(random);
  const QuadraticResult before = InteriorPoint().solve(program);
  const QuadraticWarmStart near = start_at(before);
  ASSERT_TRUE(sets.solve(program, {}, near));
  QuadraticProgram contradictory = program;  // an equation beyond what the box allows
  contradictory.row_lower(0) = contradictory.row_upper(0) = 1e3;
  EXPECT_FALSE(sets.solve(contradictory, {}, near));
  QuadraticProgram crossed = program;
  crossed.x_lower(0) = 2;
  EXPECT_FALSE(sets.solve(crossed, {}, near));
  EXPECT_FALSE(sets.solve(program, {}, {before.x, VectorXd(), before.bound_multipliers}));
  QuadraticWarmStart wild = near;
  wild.x(0) = std::nan("");
  EXPECT_FALSE(sets.solve(program, {}, wild));
  CancellationToken token;
  token.cancel();
  EXPECT_FALSE(sets.solve(program, {.cancellation = &token}, near));
}

}  // namespace
}  // namespace lapwing
