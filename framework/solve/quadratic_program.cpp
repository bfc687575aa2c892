// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/quadratic_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapwing {
namespace {

// Worst violation of lower <= v <= upper; `scale` grows with |v| where a bound is finite.
double violation(const Eigen::VectorXd& v, const Eigen::VectorXd& lower,
                 const Eigen::VectorXd& upper, double& scale) {
  double worst = 0;
  for (int i = 0; i < v.size(); ++i) {
    worst = std::max({worst, lower(i) - v(i), v(i) - upper(i)});
    if (std::isfinite(lower(i)) || std::isfinite(upper(i))) scale = std::max(scale, std::abs(v(i)));
  }
  return worst;
}

// Sum of the bounds that positive and negative multipliers push against; pushing against none is
// charged to the dual residual through `leak`; `size` grows by the terms' magnitudes.
double support(const Eigen::VectorXd& multipliers, const Eigen::VectorXd& lower,
               const Eigen::VectorXd& upper, double& leak, double& size) {
  double sum = 0;
  for (int i = 0; i < multipliers.size(); ++i) {
    const double z = multipliers(i), bound = z > 0 ? lower(i) : upper(i);
    if (std::isfinite(bound))
      sum += z * bound, size += std::abs(z * bound);
    else
      leak = std::max(leak, std::abs(z));
  }
  return sum;
}

constexpr double kRoundings = 20.0;  // roundings that add up in a sum of a few dozen terms

// P x from the lower triangle, and the sum of its terms' magnitudes.
Eigen::VectorXd symmetric_product(const Eigen::SparseMatrix<double>& lower,
                                  const Eigen::VectorXd& x, Eigen::VectorXd& magnitude) {
  Eigen::VectorXd product = Eigen::VectorXd::Zero(x.size());
  magnitude.setZero(x.size());
  for (int j = 0; j < lower.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator e(lower, j); e; ++e) {
      const auto i = e.row();
      product(i) += e.value() * x(j);
      magnitude(i) += std::abs(e.value() * x(j));
      if (i == j) continue;
      product(j) += e.value() * x(i);
      magnitude(j) += std::abs(e.value() * x(i));
    }
  return product;
}

}  // namespace

double largest_size(const Eigen::VectorXd& v) {
  return v.size() ? v.cwiseAbs().maxCoeff() : 0.0;
}

QuadraticResiduals residuals(const QuadraticProgram& problem, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& row_multipliers,
                             const Eigen::VectorXd& bound_multipliers) {
  Eigen::VectorXd magnitude;
  const Eigen::VectorXd px = symmetric_product(problem.hessian, x, magnitude);
  const Eigen::VectorXd ax = problem.jacobian * x;
  const Eigen::VectorXd aty = problem.jacobian.transpose() * row_multipliers;
  QuadraticResiduals result;
  double scale = 0, leak = 0;
  const double rows = violation(ax, problem.row_lower, problem.row_upper, scale);
  const double bounds = violation(x, problem.x_lower, problem.x_upper, scale);
  result.primal = std::max(rows, bounds) / (1.0 + scale);
  const double quadratic = x.dot(px), linear = problem.gradient.dot(x);
  double terms = x.cwiseAbs().dot(magnitude) + problem.gradient.cwiseAbs().dot(x.cwiseAbs());
  const double primal = 0.5 * quadratic + linear;
  const double dual = -0.5 * quadratic +
                      support(row_multipliers, problem.row_lower, problem.row_upper, leak, terms) +
                      support(bound_multipliers, problem.x_lower, problem.x_upper, leak, terms);
  const double dual_scale =
      1.0 + std::max({largest_size(px), largest_size(aty), largest_size(problem.gradient),
                      largest_size(bound_multipliers)});
  result.dual =
      std::max(leak, largest_size(px + problem.gradient - aty - bound_multipliers)) / dual_scale;
  const double gap_scale =
      1.0 + std::max(std::abs(primal), std::abs(problem.cost_at_zero + primal));
  result.gap = std::abs(primal - dual) / gap_scale;
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  result.dual_rounding = kRoundings * kEpsilon * largest_size(magnitude) / dual_scale;
  result.gap_rounding = kRoundings * kEpsilon * terms / gap_scale;
  return result;
}

}  // namespace lapwing
