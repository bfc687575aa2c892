#include "plugins/trajectory_solvers/nlopt/scaling.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

constexpr double kSmallest = 1e-12;        // of the largest diagonal entry, added to all of them
constexpr double kRegularisation = 1e-11;  // of each diagonal entry, where pivots stay safe
constexpr double kStronger = 100;
constexpr Eigen::Index kRows = 16;

// Products of the first j numbers of rows [begin, end) with those of row j, four rows at once.
template <class Matrix>
void products(const Matrix& matrix, Eigen::Index begin, Eigen::Index end, Eigen::Index j,
              double* dots) {
  using Four = Eigen::Array4d;
  const double* row = matrix.row(j).data();
  Eigen::Index i = begin;
  for (; i + 4 <= end; i += 4) {
    const double* rows[4];
    for (int r = 0; r < 4; ++r) rows[r] = matrix.row(i + r).data();
    Four sums[4] = {Four::Zero(), Four::Zero(), Four::Zero(), Four::Zero()};
    Eigen::Index k = 0;
    for (; k + 4 <= j; k += 4) {
      const Four shared = Eigen::Map<const Four>(row + k);
      for (int r = 0; r < 4; ++r) sums[r] += shared * Eigen::Map<const Four>(rows[r] + k);
    }
    for (int r = 0; r < 4; ++r) {
      double sum = sums[r].sum();
      for (Eigen::Index l = k; l < j; ++l) sum += row[l] * rows[r][l];
      dots[i - begin + r] = sum;
    }
  }
  for (; i < end; ++i) dots[i - begin] = matrix.row(i).head(j).dot(matrix.row(j).head(j));
}

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

// l_ij = (a_ij - l_i . l_j) / l_jj, several rows i at a time, which share the traffic of l_j. False
// when a pivot is lost to rounding.
bool Scaling::factor(double regularisation) {
  const Eigen::Index n = matrix_.rows();
  factor_.resize(n, n);
  double dots[kRows];
  for (Eigen::Index first = 0; first < n; first += kRows) {
    const Eigen::Index end = std::min(first + kRows, n);
    for (Eigen::Index j = 0; j < end; ++j) {
      const Eigen::Index begin = std::max(first, j);
      products(factor_, begin, end, j, dots);
      for (Eigen::Index i = begin; i < end; ++i) {
        if (i > j) {
          factor_(i, j) = (matrix_(i, j) - dots[i - begin]) / factor_(j, j);
          continue;
        }
        const double diagonal = matrix_(i, i) * (1.0 + regularisation);
        const double pivot = diagonal - dots[0];
        if (!(pivot > 0.5 * regularisation * diagonal)) return false;
        factor_(i, i) = std::sqrt(pivot);
      }
    }
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
