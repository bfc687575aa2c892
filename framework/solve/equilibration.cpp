// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/equilibration.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

constexpr int kPasses = 10;
constexpr double kSmallestNorm = 1e-8;  // columns with less are left as they are
constexpr double kScaleLimit = 1e6;     // of one pass's product

using Eigen::VectorXd;

double inverse_root(double norm) {
  return norm > kSmallestNorm ? 1.0 / std::sqrt(norm) : 1.0;
}

}  // namespace

void Equilibration::compute(const QuadraticProgram& problem, const std::vector<char>& fixed,
                            const std::vector<RowKind>& rows) {
  const int n = problem.variables(), m = problem.rows();
  columns_.setOnes(n);
  rows_.setOnes(m);
  cost_ = 1.0;
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  for (int pass = 0; pass < kPasses; ++pass) {
    VectorXd column = VectorXd::Zero(n), row = VectorXd::Zero(m);
    double cost = 0;
    for (int j = 0; j < n; ++j) {
      if (fixed[j]) continue;
      for (Entry e(problem.hessian, j); e; ++e) {
        const int i = static_cast<int>(e.row());
        if (i < j || fixed[i]) continue;
        const double v = cost_ * std::abs(e.value()) * columns_(i) * columns_(j);
        column(i) = std::max(column(i), v);
        column(j) = std::max(column(j), v);
      }
      for (Entry e(problem.jacobian, j); e; ++e) {
        const int r = static_cast<int>(e.row());
        if (rows[r] == RowKind::unbounded) continue;
        const double v = std::abs(e.value()) * rows_(r) * columns_(j);
        column(j) = std::max(column(j), v);
        row(r) = std::max(row(r), v);
      }
    }
    for (int j = 0; j < n; ++j)
      columns_(j) = std::clamp(columns_(j) * inverse_root(column(j)), 1 / kScaleLimit, kScaleLimit);
    for (int r = 0; r < m; ++r)
      rows_(r) = std::clamp(rows_(r) * inverse_root(row(r)), 1 / kScaleLimit, kScaleLimit);
    for (int j = 0; j < n; ++j)
      cost = std::max(cost, cost_ * std::abs(problem.gradient(j)) * columns_(j));
    double mean = 0;
    VectorXd hessian = VectorXd::Zero(n);
    for (int j = 0; j < n; ++j)
      for (Entry e(problem.hessian, j); e; ++e) {
        const int i = static_cast<int>(e.row());
        if (i < j || fixed[i] || fixed[j]) continue;
        const double v = cost_ * std::abs(e.value()) * columns_(i) * columns_(j);
        hessian(i) = std::max(hessian(i), v);
        hessian(j) = std::max(hessian(j), v);
      }
    if (n) mean = hessian.mean();
    const double norm = std::max(mean, cost);
    if (norm > kSmallestNorm) cost_ = std::clamp(cost_ / norm, 1e-12, 1e12);
  }
}

void Equilibration::apply(const QuadraticProgram& problem, QuadraticProgram& scaled) const {
  scaled.hessian = problem.hessian;
  scaled.jacobian = problem.jacobian;
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  for (int j = 0; j < problem.variables(); ++j) {
    for (Entry e(scaled.hessian, j); e; ++e)
      e.valueRef() *= cost_ * columns_(e.row()) * columns_(j);
    for (Entry e(scaled.jacobian, j); e; ++e) e.valueRef() *= rows_(e.row()) * columns_(j);
  }
  scaled.gradient = cost_ * problem.gradient.cwiseProduct(columns_);
  scaled.row_lower = problem.row_lower.cwiseProduct(rows_);
  scaled.row_upper = problem.row_upper.cwiseProduct(rows_);
  scaled.x_lower = problem.x_lower.cwiseQuotient(columns_);
  scaled.x_upper = problem.x_upper.cwiseQuotient(columns_);
}

}  // namespace lapwing
