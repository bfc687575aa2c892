// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/kkt_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/OrderingMethods>

namespace lapwing {
namespace {

// Static regularisation in scaled numbers: little on the variables, whose curvature may be tiny
// (snap leaves whole cubics free), more on the rows, which keeps pivots far from zero. Refinement
// takes both back. Where it cannot, because the rows' Schur complement is smaller still, less is
// added to the rows, as long as that helps: the factors themselves grow inexact with it.
constexpr double kOfVariables = 1e-10;
constexpr double kOfRows = 1e-6;
constexpr double kLeastOfRows = 1e-9;
constexpr double kWeaker = 0.1;
constexpr double kStronger = 100.0;  // factor of each further try
constexpr int kTries = 4;

using Eigen::VectorXd;
using Entry = Eigen::SparseMatrix<double>::InnerIterator;

bool equal(const std::vector<int>& a, const int* b, std::size_t count) {
  return a.size() == count && std::equal(a.begin(), a.end(), b);
}

}  // namespace

bool KktSystem::same_pattern(const QuadraticProgram& problem) const {
  const auto& p = problem.hessian;
  const auto& a = problem.jacobian;
  return n_ == problem.variables() && m_ == problem.rows() &&
         equal(hessian_outer_, p.outerIndexPtr(), p.outerSize() + 1) &&
         equal(hessian_inner_, p.innerIndexPtr(), p.nonZeros()) &&
         equal(jacobian_outer_, a.outerIndexPtr(), a.outerSize() + 1) &&
         equal(jacobian_inner_, a.innerIndexPtr(), a.nonZeros());
}

void KktSystem::analyse(const QuadraticProgram& problem) {
  n_ = problem.variables();
  m_ = problem.rows();
  const auto& p = problem.hessian;
  const auto& a = problem.jacobian;
  hessian_outer_.assign(p.outerIndexPtr(), p.outerIndexPtr() + p.outerSize() + 1);
  hessian_inner_.assign(p.innerIndexPtr(), p.innerIndexPtr() + p.nonZeros());
  jacobian_outer_.assign(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1);
  jacobian_inner_.assign(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros());

  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < n_; ++j) {
    for (Entry e(p, j); e; ++e) entries.emplace_back(e.row(), j, 1.0);
    for (Entry e(a, j); e; ++e) entries.emplace_back(n_ + e.row(), j, 1.0);
  }
  for (int i = 0; i < n_ + m_; ++i) entries.emplace_back(i, i, 1.0);
  Eigen::SparseMatrix<double> lower(n_ + m_, n_ + m_);
  lower.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), order);
  place_.resize(n_ + m_);
  for (int k = 0; k < n_ + m_; ++k) place_[order.indices()(k)] = k;

  for (auto& entry : entries) {
    const int i = place_[entry.row()], j = place_[entry.col()];
    entry = {std::min(i, j), std::max(i, j), 0.0};
  }
  matrix_.resize(n_ + m_, n_ + m_);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  const auto slot = [&](int i, int j) {
    const int row = std::min(place_[i], place_[j]), column = std::max(place_[i], place_[j]);
    const int* begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column];
    const int* end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - matrix_.innerIndexPtr());
  };
  hessian_slots_.clear();
  jacobian_slots_.clear();
  diagonal_slots_.clear();
  for (int j = 0; j < n_; ++j) {
    for (Entry e(p, j); e; ++e)
      hessian_slots_.push_back(e.row() > j ? slot(static_cast<int>(e.row()), j) : -1);
    for (Entry e(a, j); e; ++e) jacobian_slots_.push_back(slot(n_ + static_cast<int>(e.row()), j));
  }
  for (int i = 0; i < n_ + m_; ++i) diagonal_slots_.push_back(slot(i, i));
  factors_.analyse(matrix_);
}

void KktSystem::set_up(const QuadraticProgram& problem, const std::vector<char>& fixed,
                       const std::vector<RowKind>& rows) {
  if (!same_pattern(problem)) analyse(problem);
  fixed_ = fixed;
  rows_ = rows;
  of_rows_ = kOfRows;
  error_ = kRefined;
  last_error_ = std::numeric_limits<double>::infinity();
  base_diagonal_.setZero(n_ + m_);
  double* values = matrix_.valuePtr();
  std::size_t h = 0, a = 0;
  for (int j = 0; j < n_; ++j) {
    for (Entry e(problem.hessian, j); e; ++e, ++h) {
      if (e.row() == j)
        base_diagonal_(j) = fixed[j] ? 1.0 : e.value();
      else if (hessian_slots_[h] >= 0)
        values[hessian_slots_[h]] = fixed[j] || fixed[e.row()] ? 0.0 : e.value();
    }
    if (fixed[j]) base_diagonal_(j) = 1.0;
    for (Entry e(problem.jacobian, j); e; ++e, ++a)
      values[jacobian_slots_[a]] =
          fixed[j] || rows[e.row()] == RowKind::unbounded ? 0.0 : e.value();
  }
}

bool KktSystem::factorise(const VectorXd& diagonal) {
  if (error_ > kRefined) {
    of_rows_ = error_ < last_error_ ? std::max(kWeaker * of_rows_, kLeastOfRows)
                                    : std::min(of_rows_ / kWeaker, kOfRows);
    last_error_ = error_;
  }
  error_ = 0.0;
  double strength = 1.0;
  regularisation_.resize(n_ + m_);
  weight_.setOnes(n_ + m_);
  for (int attempt = 0; attempt < kTries; ++attempt, strength *= kStronger) {
    double* values = matrix_.valuePtr();
    for (int i = 0; i < n_; ++i) {
      regularisation_(place_[i]) = strength * kOfVariables;
      values[diagonal_slots_[i]] =
          base_diagonal_(i) + (fixed_[i] ? 0.0 : diagonal(i)) + strength * kOfVariables;
    }
    for (int r = 0; r < m_; ++r) {
      const int i = n_ + r;
      const double exact = rows_[r] == RowKind::equation    ? 0.0
                           : rows_[r] == RowKind::unbounded ? -1.0
                                                            : -1.0 / diagonal(i);
      regularisation_(place_[i]) = -strength * of_rows_;
      values[diagonal_slots_[i]] = exact - strength * of_rows_;
      weight_(place_[i]) = exact < -1.0 ? -1.0 / exact : 1.0;
    }
    if (factors_.factorise(matrix_)) return true;
  }
  return false;
}

// K x with the symmetric matrix, without the regularisation.
void KktSystem::product(const VectorXd& x, VectorXd& result) const {
  const int* const outer = matrix_.outerIndexPtr();
  const int* const inner = matrix_.innerIndexPtr();
  const double* const value = matrix_.valuePtr();
  result = -regularisation_.cwiseProduct(x);
  for (int j = 0; j < n_ + m_; ++j) {
    const double factor = x(j);
    double sum = 0;
    for (int k = outer[j]; k < outer[j + 1]; ++k) {
      const int i = inner[k];
      if (i != j) result(i) += value[k] * factor;
      sum += value[k] * x(i);
    }
    result(j) += sum;
  }
}

// Generalised conjugate residuals, the factors being the preconditioner (Eisenstat, Elman, Schultz
// 1983). Plain refinement gains a factor delta / (delta + sigma) a step, which is nothing for rows
// whose Schur complement sigma is below the regularisation delta, as it is where bounds hold many
// of a row's variables; the few such directions cost a Krylov method a few steps.
VectorXd KktSystem::solve(const VectorXd& right, double refined) {
  const int size = n_ + m_;
  // Vectors of the size of the problem are kept from solve to solve: a program takes many.
  VectorXd &ordered = scratch_.right, &x = scratch_.x, &residual = scratch_.residual;
  ordered.resize(size);
  for (int i = 0; i < size; ++i) ordered(place_[i]) = right(i);
  // The first step is taken whole: where the matrix is singular it is long, which shows a ray.
  x = ordered;
  factors_.solve(x);
  product(x, scratch_.product);
  residual = weight_.cwiseProduct(ordered - scratch_.product);
  const double scale = weight_.cwiseProduct(ordered).norm();
  for (std::size_t k = 0; k < kRefinements && residual.norm() > refined * scale; ++k) {
    VectorXd &correction = scratch_.directions[k], &image = scratch_.images[k];
    correction = residual.cwiseQuotient(weight_);
    factors_.solve(correction);
    product(correction, scratch_.product);
    image = weight_.cwiseProduct(scratch_.product);
    for (std::size_t b = 0; b < k; ++b) {
      const double share = scratch_.images[b].dot(image);
      image -= share * scratch_.images[b];
      correction -= share * scratch_.directions[b];
    }
    const double length = image.norm();
    if (!(length > 0) || !std::isfinite(length)) break;
    image /= length;
    correction /= length;
    const double step = image.dot(residual);
    x += step * correction;
    residual -= step * image;
  }
  if (scale > 0) error_ = std::max(error_, residual.norm() / scale);
  VectorXd result(size);
  for (int i = 0; i < size; ++i) result(i) = x(place_[i]);
  return result;
}

}  // namespace lapwing
