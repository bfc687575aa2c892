// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/elastic.h"

#include <cmath>
#include <limits>

namespace lapwing {

ElasticProgram make_elastic(const QuadraticProgram& problem, int first_row, bool bounds,
                            double penalty) {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  const double infinity = std::numeric_limits<double>::infinity();
  const int n = problem.variables(), m = problem.rows();
  ElasticProgram result;
  result.variables = n;
  for (int r = first_row; r < m; ++r) result.relaxed.push_back(r);
  if (bounds)
    for (int i = 0; i < n; ++i)
      if (std::isfinite(problem.x_lower(i)) || std::isfinite(problem.x_upper(i)))
        result.relaxed.push_back(m + i);
  const int k = static_cast<int>(result.relaxed.size());
  const int extra_rows = bounds ? k - (m - first_row) : 0;

  QuadraticProgram& p = result.program;
  std::vector<Eigen::Triplet<double>> hessian, jacobian;
  for (int j = 0; j < n; ++j) {
    for (Entry e(problem.hessian, j); e; ++e) hessian.emplace_back(e.row(), j, e.value());
    for (Entry e(problem.jacobian, j); e; ++e) jacobian.emplace_back(e.row(), j, e.value());
  }
  p.row_lower.resize(m + extra_rows);
  p.row_upper.resize(m + extra_rows);
  p.row_lower.head(m) = problem.row_lower;
  p.row_upper.head(m) = problem.row_upper;
  p.x_lower = Eigen::VectorXd::Zero(n + 2 * k);
  p.x_upper = Eigen::VectorXd::Constant(n + 2 * k, infinity);
  p.x_lower.head(n) = problem.x_lower;
  p.x_upper.head(n) = problem.x_upper;
  int next_row = m;
  for (int i = 0; i < k; ++i) {
    int row = result.relaxed[i];
    if (row >= m) {
      const int variable = row - m;
      row = next_row++;
      jacobian.emplace_back(row, variable, 1.0);
      p.row_lower(row) = problem.x_lower(variable);
      p.row_upper(row) = problem.x_upper(variable);
      p.x_lower(variable) = -infinity;
      p.x_upper(variable) = infinity;
    }
    jacobian.emplace_back(row, n + 2 * i, 1.0);
    jacobian.emplace_back(row, n + 2 * i + 1, -1.0);
  }
  p.hessian.resize(n + 2 * k, n + 2 * k);
  p.hessian.setFromTriplets(hessian.begin(), hessian.end());
  p.jacobian.resize(m + extra_rows, n + 2 * k);
  p.jacobian.setFromTriplets(jacobian.begin(), jacobian.end());
  p.gradient = Eigen::VectorXd::Constant(n + 2 * k, penalty);
  p.gradient.head(n) = problem.gradient;
  p.cost_at_zero = problem.cost_at_zero;
  return result;
}

}  // namespace lapwing
