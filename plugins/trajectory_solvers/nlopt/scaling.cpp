// SPDX-License-Identifier: Apache-2.0
// How: band_ holds the lower triangle of H in all columns; row c has the entries (c, c - width + 1)
// to (c, c). set_whole goes from the last column to the first and removes column c from what is
// left: a dependent one by its row (substitute), an independent one by completing the square
// (complete_square), a fixed one by setting it to 0. The row then holds b or f of scaling.h instead
// of entries of H. to_variables runs through the rows forward, to_gradient backward.
//
// A pivot can lose all its digits by cancellation. `gross_` has the sum of what was ever added to
// it; a pivot below 1e-11 of that is rounding and is raised to it.
#include "plugins/trajectory_solvers/nlopt/scaling.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

constexpr double kSmallest = 1e-12;  // of the largest diagonal entry: what costs less is free
constexpr double kRounding = 1e-11;  // of what was summed up: less than that is rounding

}  // namespace

using Eigen::VectorXd;

void Scaling::set_whole(const LocalModel& model, const AugmentedCost& cost) {
  whole_ = true;
  roots_.resize(reduced_.size());
  fill(model, cost);
  int variable = reduced_.size() - 1;
  for (int c = static_cast<int>(band_.rows()) - 1; c >= 0; --c) {
    if (reduced_.dependent(c))
      substitute(c, model);
    else if (variable >= 0 && reduced_.columns()[variable] == c)
      complete_square(c, variable--);
    else
      band_.row(c).setZero();  // fixed: x_c = 0
  }
}

// The Hessian's lower triangle in all columns, banded.
void Scaling::fill(const LocalModel& model, const AugmentedCost& cost) {
  const int n = static_cast<int>(model.hessian.cols());
  width_ = 1;
  const auto reach = [&](int a, int b) { width_ = std::max(width_, std::abs(a - b) + 1); };
  for (int c = 0; c < n; ++c) {
    if (reduced_.dependent(c))
      for (const auto& e : reduced_.row_of(c).others) reach(c, e.column);
    for (SparseMatrix::InnerIterator e(model.hessian, c); e; ++e)
      if (e.value() != 0) reach(static_cast<int>(e.row()), c);
  }
  for (const ActiveRow& row : cost.active_rows())
    reach(row.entries.front().first, row.entries.back().first);
  band_.setZero(n, width_);
  for (int c = 0; c < n; ++c)
    for (SparseMatrix::InnerIterator e(model.hessian, c); e; ++e)
      if (e.value() != 0) at(static_cast<int>(e.row()), c) += e.value();
  for (const Limited& item : cost.limited())
    if (!item.is_row && item.error != 0) at(item.index, item.index) += item.penalty;
  for (const ActiveRow& row : cost.active_rows())
    for (const auto& [a, first] : row.entries)
      for (const auto& [b, second] : row.entries)
        if (a >= b) at(a, b) += row.penalty * first * second;
  gross_ = band_.col(width_ - 1);
  smallest_ = kSmallest * std::max(gross_.maxCoeff(), 1e-300);
}

// x_c = sum b_k x_k in x'Hx. Leaves b in the band's row.
void Scaling::substitute(int column, const LocalModel& model) {
  const auto& row = reduced_.row_of(column);
  const double* values = model.jacobian.valuePtr();
  const int first = std::max(0, column - width_ + 1);
  const VectorXd h = band_.row(column).tail(column - first + 1).transpose();
  const double diagonal = h(column - first);
  VectorXd b = VectorXd::Zero(column - first + 1);
  for (const auto& e : row.others) b(e.column - first) = -values[e.slot] / values[row.pivot_slot];
  for (const auto& e : row.others) {
    const int k = e.column;
    const double factor = b(k - first);
    if (factor == 0) continue;
    for (int j = first; j < column; ++j) {
      const double change = factor * (h(j - first) + 0.5 * diagonal * b(j - first));
      at(std::max(j, k), std::min(j, k)) += j == k ? 2 * change : change;
    }
    gross_(k) += factor * factor * std::max(0.0, gross_(column));
  }
  band_.row(column).tail(column - first + 1) = b.transpose();
}

// Leaves f in the band's row.
void Scaling::complete_square(int column, int variable) {
  const int first = std::max(0, column - width_ + 1), count = column - first;
  const double diagonal = at(column, column);
  const double pivot =
      std::max({diagonal, kRounding * gross_(column), smallest_}) * (1.0 + kRounding);
  auto h = band_.row(column).tail(count + 1).head(count);
  for (int j = first; j < column; ++j) {
    const double factor = h(j - first) / pivot;
    if (factor == 0) continue;
    band_.row(j).tail(j - first + 1) -= factor * h.head(j - first + 1);
  }
  h /= pivot;
  roots_(variable) = std::sqrt(pivot);
}

void Scaling::set_diagonal(const LocalModel& model, const AugmentedCost& cost) {
  whole_ = false;
  const int n = reduced_.size();
  VectorXd unit = VectorXd::Zero(n), all, product;
  roots_.resize(n);
  for (int k = 0; k < n; ++k) {
    unit(k) = 1;
    reduced_.forward(model, unit, nullptr, all);
    unit(k) = 0;
    cost.hessian_times(model, all, product);
    roots_(k) = all.dot(product);
  }
  const double smallest = kSmallest * std::max(n > 0 ? roots_.maxCoeff() : 0.0, 1e-300);
  roots_ = roots_.cwiseMax(smallest).cwiseSqrt();
}

VectorXd Scaling::to_variables(const VectorXd& w) const {
  if (!whole_) return w.cwiseQuotient(roots_);
  VectorXd x = VectorXd::Zero(band_.rows()), v(reduced_.size());
  int variable = 0;
  for (int c = 0; c < band_.rows(); ++c) {
    const int count = std::min(c, width_ - 1);
    const double sum =
        band_.row(c).segment(width_ - 1 - count, count).dot(x.segment(c - count, count));
    if (reduced_.dependent(c)) {
      x(c) = sum;
    } else if (variable < v.size() && reduced_.columns()[variable] == c) {
      x(c) = v(variable) = w(variable) / roots_(variable) - sum;
      ++variable;
    }
  }
  return v;
}

VectorXd Scaling::to_gradient(const VectorXd& g) const {
  if (!whole_) return g.cwiseQuotient(roots_);
  VectorXd slope = VectorXd::Zero(band_.rows()), w(reduced_.size());
  int variable = reduced_.size() - 1;
  for (int c = static_cast<int>(band_.rows()) - 1; c >= 0; --c) {
    const int count = std::min(c, width_ - 1);
    const auto row = band_.row(c).segment(width_ - 1 - count, count).transpose();
    if (reduced_.dependent(c)) {
      if (slope(c) != 0) slope.segment(c - count, count) += slope(c) * row;
    } else if (variable >= 0 && reduced_.columns()[variable] == c) {
      slope(c) += g(variable);
      w(variable) = slope(c) / roots_(variable);
      slope.segment(c - count, count) -= slope(c) * row;
      --variable;
    }
  }
  return w;
}

}  // namespace lapwing
