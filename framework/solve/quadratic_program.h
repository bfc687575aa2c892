// SPDX-License-Identifier: Apache-2.0
// A sparse convex quadratic program and what a solver says of it.
//
//   minimise  x'Px/2 + c'x   subject to  row_lower <= A x <= row_upper,  x_lower <= x <= x_upper
//
// Equal bounds make an equation or fix a variable; infinite ones are none.
#pragma once

#include <algorithm>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace lapwing {

struct QuadraticProgram {
  Eigen::SparseMatrix<double> hessian;   // P, n x n, lower triangle; positive semidefinite
  Eigen::VectorXd gradient;              // c, n
  Eigen::SparseMatrix<double> jacobian;  // A, m x n
  Eigen::VectorXd row_lower, row_upper;  // m
  Eigen::VectorXd x_lower, x_upper;      // n
  double cost_at_zero = 0;               // of the problem that this one stands for, at x = 0

  int variables() const { return static_cast<int>(gradient.size()); }
  int rows() const { return static_cast<int>(jacobian.rows()); }
  double objective(const Eigen::VectorXd& x) const {
    return 0.5 * x.dot(hessian.selfadjointView<Eigen::Lower>() * x) + gradient.dot(x);
  }
};

enum class QuadraticStatus {
  optimal,
  infeasible,  // no point meets the rows and bounds; the multipliers are a certificate
  unbounded,   // the cost falls for ever along `x`
  iteration_limit,
  cancelled,
  numerical_error,
};

struct QuadraticResult {
  QuadraticStatus status = QuadraticStatus::numerical_error;
  Eigen::VectorXd x;
  // P x + c = A' row_multipliers + bound_multipliers; positive where a lower bound pushes.
  Eigen::VectorXd row_multipliers, bound_multipliers;
  int iterations = 0;
  double primal_residual = 0;  // relative, see residuals()
  double dual_residual = 0;
  double gap = 0;  // relative duality gap
};

// Relative residuals of any primal-dual point, from the problem's own numbers:
//   primal  worst violation of a row or bound, over 1 + the largest |A x| or |x| at a finite bound
//   dual    |P x + c - A'y - z|, over 1 + the largest of |P x|, |A'y|, |c|, |z|
//   gap     |primal - dual objective| over 1 + the larger of |primal objective| and the cost, which
//           is `cost_at_zero` more: a model of a large cost around its optimum has an objective
//           near 0
// The rounding fields say how far sums of the problem's size are from exact in double precision, on
// the same scale: no solver can be asked for less. Snap costs reach it, for their large
// coefficients cancel.
struct QuadraticResiduals {
  double primal = 0, dual = 0, gap = 0;
  double dual_rounding = 0, gap_rounding = 0;

  bool within(double tolerance) const {
    return primal <= tolerance && dual <= std::max(tolerance, dual_rounding) &&
           gap <= std::max(tolerance, gap_rounding);
  }
};
QuadraticResiduals residuals(const QuadraticProgram& problem, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& row_multipliers,
                             const Eigen::VectorXd& bound_multipliers);

// Of the entries without their signs; 0 where there is none.
double largest_size(const Eigen::VectorXd& v);

}  // namespace lapwing
