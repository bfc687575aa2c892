// SPDX-License-Identifier: Apache-2.0
// Compares every derivative of a trajectory problem with central differences through `retract`.
#pragma once

#include "framework/problem/trajectory_problem.h"
#include "tests/problem/laboratory.h"

namespace lapwing::laboratory {

inline Eigen::VectorXd unit_step(const TrajectoryProblem& problem, int column, double length) {
  return length * Eigen::VectorXd::Unit(problem.columns(), column);
}

// Worst entry relative to the largest one, with its name.
inline void expect_close(const Eigen::MatrixXd& value, const Eigen::MatrixXd& expected,
                         double tolerance, const std::string& what,
                         const std::function<std::string(int, int)>& name) {
  ASSERT_EQ(value.rows(), expected.rows());
  ASSERT_EQ(value.cols(), expected.cols());
  if (value.size() == 0) return;
  Eigen::Index row = 0, column = 0;
  const double worst = (value - expected).cwiseAbs().maxCoeff(&row, &column);
  const double scale = std::max(1.0, expected.cwiseAbs().maxCoeff());
  EXPECT_LE(worst, tolerance * scale)
      << what << ": " << name(static_cast<int>(row), static_cast<int>(column)) << " is "
      << value(row, column) << ", differences give " << expected(row, column);
}

inline void expect_gradient(const TrajectoryProblem& problem, const Stages& at) {
  LocalModel model;
  problem.linearise(at, model);
  EXPECT_NEAR(model.cost, problem.cost(at), 1e-12 * (1 + std::abs(model.cost)));
  const double h = 1e-5;
  Eigen::VectorXd expected(problem.columns());
  for (int c = 0; c < problem.columns(); ++c)
    expected(c) = (problem.cost(problem.retract(at, unit_step(problem, c, h))) -
                   problem.cost(problem.retract(at, unit_step(problem, c, -h)))) /
                  (2 * h);
  expect_close(model.gradient, expected, 1e-7, "gradient",
               [&](int c, int) { return problem.column_name(c); });
}

inline void expect_row_jacobian(const TrajectoryProblem& problem, const Stages& at) {
  LocalModel model;
  problem.linearise(at, model);
  EXPECT_TRUE(model.values.isApprox(problem.row_values(at), 1e-13));
  const double h = 1e-5;
  Eigen::MatrixXd expected(problem.rows(), problem.columns());
  for (int c = 0; c < problem.columns(); ++c)
    expected.col(c) = (problem.row_values(problem.retract(at, unit_step(problem, c, h))) -
                       problem.row_values(problem.retract(at, unit_step(problem, c, -h)))) /
                      (2 * h);
  expect_close(model.jacobian.toDense(), expected, 1e-8, "row Jacobian",
               [&](int r, int c) { return problem.row_name(r) + " by " + problem.column_name(c); });
}

inline Eigen::MatrixXd full(const SparseMatrix& lower) {
  return lower.toDense().selfadjointView<Eigen::Lower>();
}

// The exact Hessian against differences of the Lagrangian's gradient. On an orientation gradients
// at neighbouring points live in tangent spaces turned by half the step, which adds an
// antisymmetric part: the symmetric one is the Hessian.
inline void expect_exact_hessian(const TrajectoryProblem& problem, const Stages& at,
                                 const Eigen::VectorXd& multipliers) {
  LocalModel model;
  problem.linearise(at, model, Curvature::exact, &multipliers);
  const Eigen::MatrixXd hessian = full(model.hessian);
  EXPECT_EQ(Eigen::MatrixXd(model.hessian.triangularView<Eigen::StrictlyUpper>()).norm(), 0.0);
  const auto gradient = [&](const Stages& point) -> Eigen::VectorXd {
    LocalModel there;
    problem.linearise(point, there);
    return there.gradient + there.jacobian.transpose() * multipliers;
  };
  const double h = 1e-5;
  Eigen::MatrixXd expected(problem.columns(), problem.columns());
  for (int c = 0; c < problem.columns(); ++c)
    expected.col(c) = (gradient(problem.retract(at, unit_step(problem, c, h))) -
                       gradient(problem.retract(at, unit_step(problem, c, -h)))) /
                      (2 * h);
  expected = 0.5 * (expected + expected.transpose()).eval();
  expect_close(hessian, expected, 1e-7, "Hessian", [&](int r, int c) {
    return problem.column_name(r) + " by " + problem.column_name(c);
  });
}

// All of the above at two seeded points.
inline void expect_derivatives(const TrajectoryProblem& problem, double size) {
  for (std::uint64_t seed : {1, 2}) {
    const Stages at = random_point(problem, seed, size);
    expect_gradient(problem, at);
    expect_row_jacobian(problem, at);
    expect_exact_hessian(problem, at, random_multipliers(problem, seed + 10));
  }
}

}  // namespace lapwing::laboratory
