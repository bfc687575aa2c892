// SPDX-License-Identifier: Apache-2.0
// The quadratic program solver on problems with known answers.
#include "framework/solve/interior_point.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "tests/solve/programs.h"

namespace lapwing {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Trap (a): known solvers call it infeasible; its optimum is the origin.
TEST(InteriorPoint, SolvesTrapWithOriginOptimal) {
  MatrixXd a(2, 6);
  a << 1, 0, 1, 0, 1, 0, 2.4, 0, -2.4, 0, 0, 1;
  const VectorXd bound = numbers({2e4, 0.3491, 2e4, 0.3491, kOpen, kOpen});
  const QuadraticProgram problem =
      dense_program(numbers({61, 2e9, 61, 2e9, 1000, 100}).asDiagonal().toDenseMatrix(),
                    VectorXd::Zero(6), a, VectorXd::Zero(2), VectorXd::Zero(2), -bound, bound);
  const QuadraticResult result = InteriorPoint().solve(problem);
  ASSERT_EQ(result.status, QuadraticStatus::optimal);
  EXPECT_LT(result.x.cwiseAbs().maxCoeff(), 1e-6);
}

// Trap (b): badly scaled rows; checked by its optimality conditions.
TEST(InteriorPoint, SolvesTrapWithBadlyScaledRows) {
  MatrixXd a(2, 6);
  a << 0.9973, -156.3, 0.9973, 154.2, 1, 0, -1.619, -1.084e4, 1.612, -1.084e4, 0, 1;
  const VectorXd b = numbers({757.8, 1.255});
  const QuadraticProgram problem =
      dense_program(numbers({11, 1e7, 11, 1e7, 700, 1000}).asDiagonal().toDenseMatrix(),
                    numbers({876.8, 0, 876.8, 0, 0, 0}), a, b, b,
                    numbers({-2000, -0.3491, -2000, -0.3491, -kOpen, -kOpen}),
                    numbers({-0.0001, 0.3491, -0.0001, 0.3491, kOpen, kOpen}));
  const QuadraticResult result = InteriorPoint().solve(problem);
  ASSERT_EQ(result.status, QuadraticStatus::optimal);
  const QuadraticResiduals r =
      residuals(problem, result.x, result.row_multipliers, result.bound_multipliers);
  EXPECT_LT(r.primal, 1e-8);
  EXPECT_LT(r.dual, 1e-8);
  EXPECT_LT(r.gap, 1e-8);
}

// Rest to rest from 0 to 5 in 5 s: the minimum-snap polynomial of degree 9 has c5..c9 = 0.2016,
// -0.1344, 0.03456, -0.004032, 0.0001792. Snap is c4.. weighted: the cost is the integral of
// x''''^2.
TEST(InteriorPoint, FindsTheMinimumSnapPolynomial) {
  const double end = 5.0;
  MatrixXd p = MatrixXd::Zero(10, 10);
  const auto falling = [](int n, int k) {
    double product = 1;
    for (int i = 0; i < k; ++i) product *= n - i;
    return product;
  };
  for (int i = 4; i < 10; ++i)
    for (int j = 4; j < 10; ++j)
      p(i, j) = 2 * falling(i, 4) * falling(j, 4) * std::pow(end, i + j - 7) / (i + j - 7);
  MatrixXd a = MatrixXd::Zero(10, 10);
  VectorXd b = VectorXd::Zero(10);
  for (int d = 0; d < 5; ++d) {
    a(d, d) = falling(d, d);
    for (int i = d; i < 10; ++i) a(5 + d, i) = falling(i, d) * std::pow(end, i - d);
  }
  b(5) = 5.0;
  const VectorXd open = VectorXd::Constant(10, kOpen);
  const QuadraticProgram problem = dense_program(p, VectorXd::Zero(10), a, b, b, -open, open);
  const QuadraticResult result = InteriorPoint().solve(problem);
  ASSERT_EQ(result.status, QuadraticStatus::optimal);
  const double expected[] = {0.2016, -0.1344, 0.03456, -0.004032, 0.0001792};
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(result.x(5 + k), expected[k], 1e-6 * (1 + expected[k]));
}

struct RandomProblem {
  QuadraticProgram program;
  VectorXd solution;
};

// A random program with a known optimum: the point and its multipliers are drawn first, the
// gradient and the bounds made to fit. P may be singular; rows may repeat.
RandomProblem feasible(Random& random) {
  const int n = static_cast<int>(random.integer(1, 30));
  const int m = static_cast<int>(random.integer(0, 20));
  const int rank = static_cast<int>(random.integer(0, n));
  const auto matrix = [&](int rows, int columns, double density) {
    MatrixXd result = MatrixXd::Zero(rows, columns);
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j)
        if (random.uniform() < density) result(i, j) = random.normal();
    return result;
  };
  const MatrixXd root = matrix(rank, n, 0.5);
  const MatrixXd p = root.transpose() * root;
  MatrixXd a = matrix(m, n, 0.4);
  if (m > 2) a.row(m - 1) = a.row(0);  // dependent rows
  VectorXd x(n), row_lower(m), row_upper(m), x_lower(n), x_upper(n), y = VectorXd::Zero(m),
                                                                     z = VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) x(i) = random.normal() * std::pow(10.0, random.uniform(-1, 2));
  const VectorXd ax = a * x;
  const auto place = [&](double value, double& low, double& high, double& multiplier) {
    const auto kind = random.integer(0, 5);
    low = kind == 0 ? -kOpen : value - random.uniform(0.1, 5);
    high = kind == 1 ? kOpen : value + random.uniform(0.1, 5);
    if (kind == 2) low = value, multiplier = random.uniform(0.1, 3);
    if (kind == 3) high = value, multiplier = -random.uniform(0.1, 3);
    if (kind == 4) low = high = value, multiplier = random.normal();
  };
  for (int r = 0; r < m; ++r) place(ax(r), row_lower(r), row_upper(r), y(r));
  for (int i = 0; i < n; ++i) place(x(i), x_lower(i), x_upper(i), z(i));
  const VectorXd c = a.transpose() * y + z - p * x;
  return {dense_program(p, c, a, row_lower, row_upper, x_lower, x_upper), x};
}

TEST(InteriorPoint, AnswersRandomFeasibleProblems) {
  Random random(11);
  for (int k = 0; k < 200; ++k) {
    const RandomProblem known = feasible(random);
    const QuadraticResult result = InteriorPoint().solve(known.program);
    ASSERT_EQ(result.status, QuadraticStatus::optimal) << "problem " << k;
    const double best = known.program.objective(known.solution);
    EXPECT_NEAR(known.program.objective(result.x), best, 1e-6 * std::max(1.0, std::abs(best)))
        << "problem " << k;
    EXPECT_LT(result.primal_residual, 1e-8);
    EXPECT_LT(result.dual_residual, 1e-8);
  }
}

// A feasible program and one more row that a combination of its rows and bounds forbids.
TEST(InteriorPoint, AnswersRandomInfeasibleProblems) {
  Random random(12);
  for (int k = 0; k < 200; ++k) {
    QuadraticProgram program = feasible(random).program;
    const int n = program.variables(), m = program.rows();
    // Row: sum of w_i x_i over bounded variables, asked to exceed its largest value.
    VectorXd row = VectorXd::Zero(n);
    double reach = 0;
    for (int i = 0; i < n; ++i) {
      program.x_lower(i) = std::max(program.x_lower(i), -200.0);
      program.x_upper(i) = std::min(program.x_upper(i), 200.0);
      if (random.uniform() < 0.5 && i > 0) continue;
      row(i) = random.normal();
      reach += std::max(row(i) * program.x_lower(i), row(i) * program.x_upper(i));
    }
    MatrixXd a(m + 1, n);
    a << MatrixXd(program.jacobian), row.transpose();
    program.jacobian = a.sparseView();
    program.row_lower.conservativeResize(m + 1);
    program.row_upper.conservativeResize(m + 1);
    program.row_lower(m) = reach + random.uniform(0.01, 5);
    program.row_upper(m) = kOpen;
    EXPECT_EQ(InteriorPoint().solve(program).status, QuadraticStatus::infeasible)
        << "problem " << k;
  }
}

TEST(InteriorPoint, SaysWhenTheCostFallsForEver) {
  const VectorXd open = VectorXd::Constant(2, kOpen);
  const MatrixXd p = numbers({1, 0}).asDiagonal();
  const QuadraticProgram problem = dense_program(p, numbers({0, -1}), MatrixXd::Zero(0, 2),
                                                 VectorXd(0), VectorXd(0), -open, open);
  EXPECT_EQ(InteriorPoint().solve(problem).status, QuadraticStatus::unbounded);
}

// A long way along a slight curvature is no ray: the optimum of -x + 1e-9 x^2 / 2 is at 1e9.
TEST(InteriorPoint, SlightCurvatureIsNotUnbounded) {
  const QuadraticProgram problem =
      dense_program(MatrixXd::Constant(1, 1, 1e-9), numbers({-1}), MatrixXd::Zero(0, 1),
                    VectorXd(0), VectorXd(0), numbers({0}), numbers({kOpen}));
  const QuadraticResult result = InteriorPoint().solve(problem);
  ASSERT_EQ(result.status, QuadraticStatus::optimal);
  EXPECT_NEAR(result.x(0), 1e9, 1e3);
}

// Numbers whose products overflow end in a status, with a point of the right size.
TEST(InteriorPoint, HugeNumbersEndInAStatus) {
  MatrixXd a(2, 2);
  a << 1, 1e300, 1e-300, 1;
  const VectorXd open = VectorXd::Constant(2, kOpen);
  const QuadraticProgram problem =
      dense_program(MatrixXd::Identity(2, 2) * 1e300, numbers({1e308, -1e308}), a,
                    numbers({1e308, -1e308}), numbers({1e308, 1e308}), -open, open);
  const QuadraticResult result = InteriorPoint().solve(problem);
  EXPECT_NE(result.status, QuadraticStatus::optimal);
  EXPECT_EQ(result.x.size(), 2);
}

TEST(InteriorPoint, RefusesCrossedBoundsAndBadNumbers) {
  QuadraticProgram problem =
      dense_program(MatrixXd::Identity(1, 1), numbers({0}), MatrixXd::Zero(0, 1), VectorXd(0),
                    VectorXd(0), numbers({2}), numbers({1}));
  EXPECT_EQ(InteriorPoint().solve(problem).status, QuadraticStatus::infeasible);
  problem.gradient(0) = std::nan("");
  EXPECT_THROW(InteriorPoint().solve(problem), Error);
}

TEST(InteriorPoint, WarmStartFromTheSolutionTakesFewerIterations) {
  Random random(13);
  int cold = 0, warm = 0;
  for (int k = 0; k < 30; ++k) {
    const QuadraticProgram program = feasible(random).program;
    InteriorPoint solver;
    const QuadraticResult first = solver.solve(program);
    const QuadraticResult second = solver.solve(
        program, {}, QuadraticWarmStart{first.x, first.row_multipliers, first.bound_multipliers});
    ASSERT_EQ(second.status, QuadraticStatus::optimal) << "problem " << k;
    cold += first.iterations;
    warm += second.iterations;
  }
  EXPECT_LT(warm, cold);
}

}  // namespace
}  // namespace lapwing
