// SPDX-License-Identifier: Apache-2.0
// Residuals, proofs, the elastic form and scaling, on programs that are solved by hand.
#include "framework/solve/quadratic_program.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/solve/elastic.h"
#include "framework/solve/equilibration.h"
#include "framework/solve/infeasibility.h"
#include "framework/solve/interior_point.h"
#include "framework/solve/local_program.h"
#include "tests/solve/programs.h"

namespace lapwing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(int rows, int columns, Random& random) {
  MatrixXd matrix(rows, columns);
  for (double& x : matrix.reshaped()) x = random.normal();
  return matrix;
}

// minimise x^2/2 - 3x + y^2  with  x + y >= 1,  x <= 1,  y free. At (1, 0): z = (-2, 0), y = 0.
QuadraticProgram corner() {
  MatrixXd a(1, 2);
  a << 1, 1;
  return dense_program(numbers({1, 2}).asDiagonal(), numbers({-3, 0}), a, numbers({1}),
                       numbers({kOpen}), numbers({-kOpen, -kOpen}), numbers({1, kOpen}));
}

TEST(Residuals, VanishAtTheOptimumAlone) {
  const QuadraticProgram program = corner();
  const auto at = [&](double x, double y, double row, double z) {
    return residuals(program, numbers({x, y}), numbers({row}), numbers({z, 0}));
  };
  const QuadraticResiduals best = at(1, 0, 0, -2);
  EXPECT_EQ(best.primal, 0);
  EXPECT_EQ(best.dual, 0);
  EXPECT_EQ(best.gap, 0);
  EXPECT_TRUE(best.within(0));
  // x = 1.5 breaks its bound by 0.5; the scale is 1 + max(|x| at a bound, |row|) = 2.5.
  EXPECT_DOUBLE_EQ(at(1.5, 0, 0, -2).primal, 0.5 / 2.5);
  // The row is broken by 4 at (1, -4), where A x = -3: the free y does not count in the scale.
  EXPECT_DOUBLE_EQ(at(1, -4, 0, -2).primal, 4.0 / 4.0);
  // P x + c = (-2, 0) is left over; the scale is 1 + |c|.
  EXPECT_DOUBLE_EQ(at(1, 0, 0, 0).dual, 2.0 / 4.0);
  // Primal objective -2.5, dual -1/2 + 0 = -0.5.
  EXPECT_DOUBLE_EQ(at(1, 0, 0, 0).gap, 2.0 / 3.5);
  EXPECT_FALSE(at(1, 0, 0, 0).within(0.4));
  EXPECT_TRUE(at(1, 0, 0, 0).within(0.6));
}

// A multiplier that pushes against no bound proves nothing: it counts as a dual residual.
TEST(Residuals, PushingAgainstNoBoundIsCharged) {
  const QuadraticProgram program = corner();
  // Row: only a lower bound, so that -1 pushes against nothing, whatever else balances.
  const QuadraticResiduals row =
      residuals(program, numbers({1, 0}), numbers({-1}), numbers({-1, 1}));
  EXPECT_GE(row.dual, 1.0 / 4.0);
  const QuadraticResiduals bound =
      residuals(program, numbers({1, 0}), numbers({0}), numbers({3, 0}));
  EXPECT_GE(bound.dual, 3.0 / 4.0) << "x has no lower bound";
}

TEST(Residuals, RoundingGrowsWithNumbersThatCancel) {
  MatrixXd p(2, 2);
  p << 1e12, -1e12, -1e12, 1e12;
  const VectorXd open = VectorXd::Constant(2, kOpen);
  const QuadraticProgram program = box_program(p, VectorXd::Zero(2), -open, open);
  const QuadraticResiduals r = residuals(program, numbers({1, 1}), VectorXd(0), VectorXd::Zero(2));
  EXPECT_EQ(r.dual, 0) << "the products cancel exactly";
  EXPECT_GT(r.dual_rounding, 1e-4) << "but sums of this size are exact to 1e-3 at best";
  EXPECT_LT(r.dual_rounding, 1e-1);
  const QuadraticProgram calm =
      box_program(MatrixXd::Identity(2, 2), VectorXd::Zero(2), -open, open);
  EXPECT_LT(residuals(calm, numbers({1, 1}), VectorXd(0), VectorXd::Zero(2)).dual_rounding, 1e-14);
}

TEST(Residuals, NothingAtAllIsOptimal) {
  const QuadraticProgram none = box_program(MatrixXd(0, 0), VectorXd(0), VectorXd(0), VectorXd(0));
  const QuadraticResiduals r = residuals(none, VectorXd(0), VectorXd(0), VectorXd(0));
  EXPECT_TRUE(r.within(0));
  EXPECT_EQ(largest_size(VectorXd(0)), 0);
  EXPECT_EQ(largest_size(numbers({1, -3, 2})), 3);
}

TEST(QuadraticProgram, ObjectiveReadsTheLowerTriangleAsAWhole) {
  Random random(1);
  const MatrixXd root = random_matrix(4, 4, random);
  const MatrixXd p = root.transpose() * root;
  const VectorXd c = random_matrix(4, 1, random), x = random_matrix(4, 1, random);
  const VectorXd open = VectorXd::Constant(4, kOpen);
  EXPECT_NEAR(box_program(p, c, -open, open).objective(x), 0.5 * x.dot(p * x) + c.dot(x), 1e-12);
}

// x >= 2 and x <= 1 as rows: y = (1, -1) adds up to 0 x >= 1.
TEST(Infeasibility, ContradictoryRowsHaveAProof) {
  const MatrixXd a = MatrixXd::Ones(2, 1);
  const QuadraticProgram program =
      dense_program(MatrixXd::Identity(1, 1), numbers({0}), a, numbers({2, -kOpen}),
                    numbers({kOpen, 1}), numbers({-kOpen}), numbers({kOpen}));
  QuadraticResult at;
  at.x = numbers({1.5});
  at.bound_multipliers = numbers({0});
  const auto proves = [&](double first, double second) {
    at.row_multipliers = numbers({first, second});
    return is_infeasibility_certificate(program, at);
  };
  EXPECT_TRUE(proves(1, -1));
  EXPECT_TRUE(proves(1e6, -1e6)) << "proofs have no scale";
  EXPECT_TRUE(proves(1e-6, -1e-6));
  EXPECT_FALSE(proves(1, -0.5)) << "x could still take up the difference";
  EXPECT_FALSE(proves(-1, 1)) << "the wrong signs push against nothing";
  EXPECT_FALSE(proves(0, 0));
  at.row_multipliers = numbers({std::nan(""), -1});
  EXPECT_FALSE(is_infeasibility_certificate(program, at));
}

// x + y >= 5 within 0 <= x, y <= 2: the bounds take up what the row pushes to.
TEST(Infeasibility, BoundsTakePartInAProof) {
  const MatrixXd a = MatrixXd::Ones(1, 2);
  QuadraticProgram program = dense_program(MatrixXd::Zero(2, 2), numbers({0, 0}), a, numbers({5}),
                                           numbers({kOpen}), numbers({0, 0}), numbers({2, 2}));
  QuadraticResult at;
  at.x = numbers({2, 2});
  at.row_multipliers = numbers({1});
  at.bound_multipliers = numbers({-1, -1});
  EXPECT_TRUE(is_infeasibility_certificate(program, at));
  program.row_lower(0) = 4;
  EXPECT_FALSE(is_infeasibility_certificate(program, at)) << "one point is left: (2, 2)";
  program.row_lower(0) = 5;
  program.x_upper(1) = kOpen;
  EXPECT_FALSE(is_infeasibility_certificate(program, at)) << "y may grow";
}

TEST(Infeasibility, RaysFallForEverAndMeetNothing) {
  MatrixXd a(1, 2);
  a << 1, -1;
  QuadraticProgram program =
      dense_program(MatrixXd::Zero(2, 2), numbers({-1, 0}), a, numbers({-kOpen}), numbers({3}),
                    numbers({0, 0}), numbers({kOpen, kOpen}));
  EXPECT_TRUE(is_unbounded_ray(program, numbers({1, 1})));
  EXPECT_TRUE(is_unbounded_ray(program, numbers({1e9, 2e9})));
  EXPECT_FALSE(is_unbounded_ray(program, numbers({2, 1}))) << "the row ends it";
  EXPECT_FALSE(is_unbounded_ray(program, numbers({0, 1}))) << "no gain";
  EXPECT_FALSE(is_unbounded_ray(program, numbers({-1, -1}))) << "the cost rises";
  EXPECT_FALSE(is_unbounded_ray(program, numbers({0, 0})));
  EXPECT_FALSE(is_unbounded_ray(program, numbers({std::nan(""), 1})));
  program.x_upper(0) = 1e12;
  EXPECT_FALSE(is_unbounded_ray(program, numbers({1, 1}))) << "a far bound is a bound";
  program.x_upper(0) = kOpen;
  program.hessian.coeffRef(1, 1) = 1e-3;
  EXPECT_FALSE(is_unbounded_ray(program, numbers({1, 1}))) << "curvature wins in the end";
  EXPECT_FALSE(is_unbounded_ray(program, numbers({1e9, 1e9})));
}

// |x - a_1| + ... + |x - a_5| is least at the median.
TEST(Elastic, LeastSumOfViolationsIsTheMedian) {
  const VectorXd places = numbers({-4, 10, 3, 0.5, 7});
  const QuadraticProgram rows =
      dense_program(MatrixXd::Zero(1, 1), numbers({0}), MatrixXd::Ones(5, 1), places, places,
                    numbers({-kOpen}), numbers({kOpen}));
  const ElasticProgram elastic = make_elastic(rows, 0, false, 2.0);
  EXPECT_EQ(elastic.variables, 1);
  EXPECT_EQ(elastic.relaxed, (std::vector<int>{0, 1, 2, 3, 4}));
  const QuadraticResult result = InteriorPoint().solve(elastic.program);
  ASSERT_EQ(result.status, QuadraticStatus::optimal);
  EXPECT_NEAR(result.x(0), 3, 1e-6);
  EXPECT_NEAR(elastic.program.objective(result.x), 2.0 * (7 + 7 + 0 + 2.5 + 4), 1e-6);
}

// minimise x^2/2 with x >= 1 has the multiplier 1: a smaller penalty gives in, a larger does not.
TEST(Elastic, APenaltyIsExactFromTheMultiplierOn) {
  const QuadraticProgram row =
      dense_program(MatrixXd::Identity(1, 1), numbers({0}), MatrixXd::Ones(1, 1), numbers({1}),
                    numbers({kOpen}), numbers({-kOpen}), numbers({kOpen}));
  const QuadraticProgram bound =
      box_program(MatrixXd::Identity(1, 1), numbers({0}), numbers({1}), numbers({kOpen}));
  for (const auto& [penalty, expected] :
       {std::pair{0.25, 0.25}, {0.75, 0.75}, {1.5, 1.0}, {40.0, 1.0}}) {
    const ElasticProgram by_row = make_elastic(row, 0, false, penalty);
    EXPECT_NEAR(InteriorPoint().solve(by_row.program).x(0), expected, 1e-6) << penalty;
    const ElasticProgram by_bound = make_elastic(bound, 0, true, penalty);
    EXPECT_EQ(by_bound.relaxed, std::vector<int>{0}) << "row m + 0, with no rows";
    EXPECT_NEAR(InteriorPoint().solve(by_bound.program).x(0), expected, 1e-6) << penalty;
  }
}

TEST(Elastic, RowsBeforeTheFirstAndBoundsStayHard) {
  // Row 0: x + y = 4, hard. Row 1: x = 1 and bound y <= 2 contradict it by 1.
  MatrixXd a(2, 2);
  a << 1, 1, 1, 0;
  const QuadraticProgram program =
      dense_program(MatrixXd::Zero(2, 2), numbers({0, 0}), a, numbers({4, 1}), numbers({4, 1}),
                    numbers({-kOpen, -kOpen}), numbers({kOpen, 2}));
  const ElasticProgram rows = make_elastic(program, 1, false, 1.0);
  EXPECT_EQ(rows.relaxed, std::vector<int>{1});
  const QuadraticResult by_row = InteriorPoint().solve(rows.program);
  ASSERT_EQ(by_row.status, QuadraticStatus::optimal);
  EXPECT_NEAR(by_row.x(0), 2, 1e-6);
  EXPECT_NEAR(by_row.x(1), 2, 1e-6);
  EXPECT_NEAR(rows.program.objective(by_row.x), 1, 1e-6);
  // With bounds the unbounded x is not relaxed, and y's bound becomes a row that may be missed.
  const ElasticProgram both = make_elastic(program, 2, true, 1.0);
  EXPECT_EQ(both.relaxed, std::vector<int>{3});
  const QuadraticResult by_bound = InteriorPoint().solve(both.program);
  ASSERT_EQ(by_bound.status, QuadraticStatus::optimal);
  EXPECT_NEAR(by_bound.x(0), 1, 1e-6);
  EXPECT_NEAR(by_bound.x(1), 3, 1e-6);
  EXPECT_NEAR(both.program.objective(by_bound.x), 1, 1e-6);
}

// Of a program with a solution the elastic form has the same one, under a large enough penalty.
TEST(Elastic, LeavesAFeasibleProgramItsSolution) {
  Random random(2);
  int feasible = 0;
  for (int k = 0; k < 20; ++k) {
    const int n = 5, m = 3;
    const MatrixXd root = random_matrix(n, n, random);
    const MatrixXd a = random_matrix(m, n, random);
    const VectorXd middle = a * random_matrix(n, 1, random);
    const VectorXd width = VectorXd::Constant(m, k % 2 ? 0.0 : 0.1);
    const QuadraticProgram program = dense_program(
        root.transpose() * root + MatrixXd::Identity(n, n), random_matrix(n, 1, random), a,
        middle - width, middle + width, VectorXd::Constant(n, -4), VectorXd::Constant(n, 4));
    const QuadraticResult hard = InteriorPoint().solve(program);
    if (hard.status != QuadraticStatus::optimal) continue;  // the box may cut all points off
    ++feasible;
    const double penalty = 10 + 10 * std::max(largest_size(hard.row_multipliers),
                                              largest_size(hard.bound_multipliers));
    for (const bool bounds : {false, true}) {
      const ElasticProgram elastic = make_elastic(program, 0, bounds, penalty);
      const QuadraticResult soft = InteriorPoint().solve(elastic.program);
      ASSERT_EQ(soft.status, QuadraticStatus::optimal) << k;
      EXPECT_LT((soft.x.head(n) - hard.x).norm(), 1e-5) << k;
      EXPECT_LT(largest_size(soft.x.tail(soft.x.size() - n)), 1e-5) << k;
    }
  }
  EXPECT_GT(feasible, 12);
}

// All of a program's numbers are scaled by the same D, E and sigma: dual rows of the scaled program
// are sigma D times those of the program, whatever the point.
TEST(Equilibration, ScalesTheOptimalityConditions) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const int n = 6, m = 4;
    MatrixXd root = random_matrix(n, n, random), a = random_matrix(m, n, random);
    for (int j = 0; j < n; ++j) {
      const double size = std::pow(10.0, random.uniform(-3, 3));
      root.col(j) *= size;
      a.col(j) *= size;
    }
    const QuadraticProgram program = dense_program(
        root.transpose() * root, random_matrix(n, 1, random), a, VectorXd::Constant(m, -1),
        VectorXd::Constant(m, kOpen), VectorXd::Constant(n, -kOpen), VectorXd::Constant(n, 2));
    Equilibration scaling;
    scaling.compute(program, std::vector<char>(n, 0), std::vector<RowKind>(m, RowKind::inequality));
    QuadraticProgram scaled;
    scaling.apply(program, scaled);
    const VectorXd x = random_matrix(n, 1, random), y = random_matrix(m, 1, random),
                   z = random_matrix(n, 1, random);
    const VectorXd xs = scaling.scaled_x(x), ys = scaling.scaled_row_multipliers(y),
                   zs = scaling.scaled_bound_multipliers(z);
    EXPECT_LT((scaling.unscaled_x(xs) - x).norm(), 1e-12);
    EXPECT_LT((scaling.unscaled_row_multipliers(ys) - y).norm(), 1e-12);
    EXPECT_LT((scaling.unscaled_bound_multipliers(zs) - z).norm(), 1e-12);
    const auto left = [](const QuadraticProgram& of, const VectorXd& at, const VectorXd& row,
                         const VectorXd& bound) {
      return VectorXd(of.hessian.selfadjointView<Eigen::Lower>() * at + of.gradient -
                      of.jacobian.transpose() * row - bound);
    };
    const VectorXd expected = left(program, x, y, z);
    // Through the multipliers' own scaling, so that sigma and D need not be known.
    EXPECT_LT((scaling.unscaled_bound_multipliers(left(scaled, xs, ys, zs)) - expected).norm(),
              1e-9 * expected.norm());
    EXPECT_EQ(scaled.row_upper, program.row_upper) << "no bound stays none";
    EXPECT_EQ(scaled.x_lower, program.x_lower);
    EXPECT_TRUE((scaled.row_lower.array() < 0).all());
    // Columns of [P A'; A 0] have about unit norm (Ruiz), and rows of A too.
    const MatrixXd whole = scaled.hessian.toDense().selfadjointView<Eigen::Lower>();
    const MatrixXd rows = scaled.jacobian.toDense();
    for (int j = 0; j < n; ++j) {
      const double norm = std::max(largest_size(whole.col(j)), largest_size(rows.col(j)));
      EXPECT_GT(norm, 0.1) << j;
      EXPECT_LT(norm, 10) << j;
    }
    for (int r = 0; r < m; ++r) {
      EXPECT_GT(largest_size(rows.row(r)), 0.1) << r;
      EXPECT_LT(largest_size(rows.row(r)), 10) << r;
    }
  }
}

// What is fixed or bounds nothing has no say in the scales of the rest.
TEST(Equilibration, FixedColumnsAndFreeRowsDoNotCount) {
  Random random(4);
  const MatrixXd root = random_matrix(3, 3, random), a = random_matrix(2, 3, random);
  const MatrixXd p = root.transpose() * root;
  const auto scale_of = [&](double fixed_size, double free_size) {
    MatrixXd hessian = p, rows = a;
    hessian.row(2) *= fixed_size;
    hessian.col(2) *= fixed_size;
    rows.col(2) *= fixed_size;
    rows.row(1) *= free_size;
    const QuadraticProgram program =
        dense_program(hessian, numbers({1, 1, 1}), rows, numbers({0, -kOpen}), numbers({1, kOpen}),
                      numbers({0, 0, 5}), numbers({1, 1, 5}));
    Equilibration scaling;
    scaling.compute(program, {0, 0, 1}, {RowKind::inequality, RowKind::unbounded});
    return VectorXd(scaling.unscaled_x(VectorXd::Ones(3)).head(2));
  };
  EXPECT_EQ(scale_of(1, 1), scale_of(1e5, 1));
  EXPECT_EQ(scale_of(1, 1), scale_of(1, 1e7));
}

TEST(Equilibration, EmptyColumnsAndRowsStayFinite) {
  const QuadraticProgram program =
      dense_program(MatrixXd::Zero(2, 2), numbers({0, 0}), MatrixXd::Zero(1, 2), numbers({-1}),
                    numbers({1}), numbers({0, 0}), numbers({1, 1}));
  Equilibration scaling;
  scaling.compute(program, {0, 0}, {RowKind::inequality});
  EXPECT_EQ(scaling.scaled_x(numbers({3, 4})), numbers({3, 4}));
  QuadraticProgram scaled;
  scaling.apply(program, scaled);
  EXPECT_EQ(scaled.row_upper, numbers({1}));
}

// A step d from x: rows read lower <= c + A d <= upper, so that c moves to the other side.
TEST(LocalProgram, IsTheLocalModelAsAProgramOfTheStep) {
  Random random(5);
  LocalModel model;
  model.cost = 7;
  model.gradient = numbers({1, -2});
  model.hessian = MatrixXd(numbers({2, 3}).asDiagonal()).sparseView();
  model.jacobian = MatrixXd::Ones(1, 2).sparseView();
  model.values = numbers({10});
  model.row_lower = numbers({4});
  model.row_upper = numbers({kOpen});
  model.step_lower = numbers({-1, -kOpen});
  model.step_upper = numbers({5, 6});
  const QuadraticProgram program = local_program(model);
  EXPECT_EQ(program.row_lower, numbers({-6}));
  EXPECT_EQ(program.row_upper, numbers({kOpen}));
  EXPECT_EQ(program.x_lower, model.step_lower);
  EXPECT_EQ(program.x_upper, model.step_upper);
  EXPECT_DOUBLE_EQ(program.objective(numbers({1, 1})), 0.5 * 5 + 1 - 2) << "without the constant";
}

}  // namespace
}  // namespace lapwing
