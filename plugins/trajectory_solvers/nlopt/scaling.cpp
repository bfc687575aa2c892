#include "plugins/trajectory_solvers/nlopt/scaling.h"

#include <cmath>

namespace lapwing {
namespace {

constexpr double kSmallest = 1e-12;        // of the largest diagonal entry, added to all of them
constexpr double kRegularisation = 1e-11;  // of each diagonal entry, where pivots stay safe
constexpr double kStronger = 100;

}  // namespace

using Eigen::VectorXd;

void Scaling::set(int n, bool dense, const std::function<void(int, VectorXd& result)>& column) {
  dense_ = dense;
  roots_.resize(n);
  if (dense) matrix_.resize(n, n);
  VectorXd result(n);
  for (int k = 0; k < n; ++k) {
    column(k, result);
    roots_(k) = result(k);
    if (dense) matrix_.row(k) = result.transpose();
  }
  const double largest = n > 0 ? std::max(roots_.maxCoeff(), 1e-300) : 1.0;
  roots_.array() += kSmallest * largest;
  if (dense) {
    matrix_.diagonal() = roots_;
    for (double r = kRegularisation; !factor(r);) r *= kStronger;
  }
  roots_ = roots_.cwiseMax(kSmallest * largest).cwiseSqrt();
}

// Row by row: l_ij = (a_ij - l_i . l_j) / l_jj. False when a pivot is lost to rounding.
bool Scaling::factor(double regularisation) {
  const Eigen::Index n = matrix_.rows();
  factor_.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double dot = factor_.row(i).head(j).dot(factor_.row(j).head(j));
      factor_(i, j) = (matrix_(i, j) - dot) / factor_(j, j);
    }
    const double diagonal = matrix_(i, i) * (1.0 + regularisation);
    const double pivot = diagonal - factor_.row(i).head(i).squaredNorm();
    if (!(pivot > 0.5 * regularisation * diagonal)) return false;
    factor_(i, i) = std::sqrt(pivot);
  }
  return true;
}

VectorXd Scaling::to_variables(const VectorXd& w) const {
  if (!dense_) return w.cwiseQuotient(roots_);
  VectorXd v = w;  // L' v = w
  for (Eigen::Index i = v.size() - 1; i >= 0; --i) {
    v(i) /= factor_(i, i);
    v.head(i) -= v(i) * factor_.row(i).head(i).transpose();
  }
  return v;
}

VectorXd Scaling::to_gradient(const VectorXd& g) const {
  if (!dense_) return g.cwiseQuotient(roots_);
  VectorXd w(g.size());  // L w = g
  for (Eigen::Index i = 0; i < w.size(); ++i)
    w(i) = (g(i) - factor_.row(i).head(i).dot(w.head(i).transpose())) / factor_(i, i);
  return w;
}

}  // namespace lapwing
