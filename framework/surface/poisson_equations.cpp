// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/poisson_equations.h"

#include <cmath>
#include <numeric>

namespace lapwing {
namespace {

// The entries row by row.
class Rows {
 public:
  explicit Rows(const PoissonMatrix& matrix)
      : starts_(matrix.rows() + 1, 0), diagonal_(matrix.rows(), 0) {
    const auto& entries = matrix.entries();
    for (const auto& e : entries) ++starts_[e.row + 1];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    columns_.resize(entries.size());
    values_.resize(entries.size());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (const auto& e : entries) {
      columns_[next[e.row]] = e.column;
      values_[next[e.row]++] = e.value;
      if (e.row == e.column) diagonal_[e.row] += e.value;
    }
  }

  void multiply(const std::vector<double>& x, std::vector<double>& y) const {
    for (std::size_t row = 0; row + 1 < starts_.size(); ++row) {
      double sum = 0;
      for (std::size_t k = starts_[row]; k < starts_[row + 1]; ++k) {
        sum += values_[k] * x[columns_[k]];
      }
      y[row] = sum;
    }
  }
  const std::vector<double>& diagonal() const { return diagonal_; }

 private:
  std::vector<std::size_t> starts_, columns_;
  std::vector<double> values_, diagonal_;
};

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

bool PoissonSolver::linear_solver(const Matrix& a, const Vector& b, Vector& x,
                                  double& scale) const {
  scale = 1;
  const Rows rows(a);
  const std::size_t n = a.rows();
  for (const double d : rows.diagonal())
    if (!(d > 0) || !std::isfinite(d)) return false;
  std::vector<double> solution(n, 0), residual(n), direction(n), product(n), scaled(n);
  for (std::size_t i = 0; i < n; ++i) residual[i] = b[i];
  const double goal = 1e-18 * dot(residual, residual);
  if (!std::isfinite(goal)) return false;
  const auto precondition = [&] {
    for (std::size_t i = 0; i < n; ++i) scaled[i] = residual[i] / rows.diagonal()[i];
    return dot(residual, scaled);
  };
  double slope = precondition();
  direction = scaled;
  for (std::size_t k = 0; k < 20 * n + 100 && dot(residual, residual) > goal; ++k) {
    rows.multiply(direction, product);
    const double curvature = dot(direction, product);
    if (!(curvature > 0)) return false;
    const double step = slope / curvature;
    for (std::size_t i = 0; i < n; ++i) {
      solution[i] += step * direction[i];
      residual[i] -= step * product[i];
    }
    const double before = slope;
    slope = precondition();
    for (std::size_t i = 0; i < n; ++i) direction[i] = scaled[i] + slope / before * direction[i];
  }
  for (std::size_t i = 0; i < n; ++i) x[i] = solution[i];
  return dot(residual, residual) <= goal;
}

}  // namespace lapwing
