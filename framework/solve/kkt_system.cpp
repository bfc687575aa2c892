#include "framework/solve/kkt_system.h"

#include <algorithm>

namespace lapwing {
namespace {

constexpr double kRegularisation = 1e-9;  // first try, scaled numbers
constexpr double kStronger = 100.0;       // factor of each further try
constexpr int kTries = 4;
constexpr int kRefinements = 8;
constexpr double kRefined = 1e-13;  // relative residual that is good enough

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
    entries.emplace_back(j, j, 0.0);
    for (Entry e(p, j); e; ++e)
      if (e.row() > j) entries.emplace_back(e.row(), j, 0.0);
    for (Entry e(a, j); e; ++e) entries.emplace_back(n_ + e.row(), j, 0.0);
  }
  for (int r = 0; r < m_; ++r) entries.emplace_back(n_ + r, n_ + r, 0.0);
  matrix_.resize(n_ + m_, n_ + m_);
  matrix_.setFromTriplets(entries.begin(), entries.end());

  const auto slot = [&](int row, int column) {
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
  factors_.analyzePattern(matrix_);
}

void KktSystem::set_up(const QuadraticProgram& problem, const std::vector<char>& fixed,
                       const std::vector<RowKind>& rows) {
  if (!same_pattern(problem)) analyse(problem);
  fixed_ = fixed;
  rows_ = rows;
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
  double regularisation = kRegularisation;
  regularisation_.resize(n_ + m_);
  for (int attempt = 0; attempt < kTries; ++attempt, regularisation *= kStronger) {
    double* values = matrix_.valuePtr();
    for (int i = 0; i < n_; ++i) {
      regularisation_(i) = regularisation;
      values[diagonal_slots_[i]] =
          base_diagonal_(i) + (fixed_[i] ? 0.0 : diagonal(i)) + regularisation;
    }
    for (int r = 0; r < m_; ++r) {
      const int i = n_ + r;
      const double exact = rows_[r] == RowKind::equation    ? 0.0
                           : rows_[r] == RowKind::unbounded ? -1.0
                                                            : -1.0 / diagonal(i);
      regularisation_(i) = -regularisation;
      values[diagonal_slots_[i]] = exact - regularisation;
    }
    factors_.factorize(matrix_);
    if (factors_.info() == Eigen::Success && factors_.vectorD().allFinite()) return true;
  }
  return false;
}

VectorXd KktSystem::solve(const VectorXd& right) const {
  VectorXd x = factors_.solve(right);
  const double scale = right.size() ? right.cwiseAbs().maxCoeff() : 0.0;
  double last = std::numeric_limits<double>::infinity();
  VectorXd best = x;
  for (int k = 0; k < kRefinements; ++k) {
    VectorXd residual = right - matrix_.selfadjointView<Eigen::Lower>() * x;
    residual += regularisation_.cwiseProduct(x);
    const double size = residual.size() ? residual.cwiseAbs().maxCoeff() : 0.0;
    if (!(size < last)) return best;
    best = x;
    last = size;
    if (size <= kRefined * scale) return x;
    x += factors_.solve(residual);
  }
  return best;
}

}  // namespace lapwing
