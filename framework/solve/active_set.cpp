// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/active_set.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr int kMostSystems = 6;         // until the set is given up
constexpr double kSoft = 1e4;           // scaled: of a bound in a soft step, force per violation
constexpr double kSystemSolved = 1e-7;  // relative residual of a linear system
// Scaled: what a bound may be broken by, for rounding; and at a point that is worth drawing.
constexpr double kBroken = 1e-10, kDrawable = 1e-3;

}  // namespace

std::optional<QuadraticResult> ActiveSet::solve(const QuadraticProgram& problem,
                                                const InteriorPointOptions& options,
                                                const QuadraticWarmStart& near) {
  if (near.x.size() != problem.variables() || near.row_multipliers.size() != problem.rows() ||
      near.bound_multipliers.size() != problem.variables() || !near.x.allFinite() ||
      !near.row_multipliers.allFinite() || !near.bound_multipliers.allFinite() ||
      (problem.x_lower.array() > problem.x_upper.array()).any() ||
      (problem.row_lower.array() > problem.row_upper.array()).any())
    return {};
  begin(problem, near);
  for (int k = 1; k <= kMostSystems; ++k) {
    if (options.cancellation && options.cancellation->cancelled()) return {};
    const bool exact = step();
    if (!exact && !soft_step()) return {};
    choose_next();
    if (k == 1 && options.early && broken_ <= kDrawable) options.early(scaling_.unscaled_x(x_));
    if (changes_ > 0) continue;
    if (!exact) return {};
    std::optional<QuadraticResult> found = result(problem, options.tolerance);
    if (found) found->iterations = k;
    return found;
  }
  return {};
}

void ActiveSet::begin(const QuadraticProgram& problem, const QuadraticWarmStart& near) {
  const int n = problem.variables(), m = problem.rows();
  always_fixed_.assign(n, 0);
  for (int i = 0; i < n; ++i) always_fixed_[i] = problem.x_lower(i) == problem.x_upper(i);
  kinds_.assign(m, RowKind::inequality);
  for (int r = 0; r < m; ++r) {
    if (problem.row_lower(r) == problem.row_upper(r))
      kinds_[r] = RowKind::equation;
    else if (!std::isfinite(problem.row_lower(r)) && !std::isfinite(problem.row_upper(r)))
      kinds_[r] = RowKind::unbounded;
  }
  scaling_.compute(problem, always_fixed_, kinds_);
  scaling_.apply(problem, p_);
  x_ = scaling_.scaled_x(near.x);
  y_ = scaling_.scaled_row_multipliers(near.row_multipliers);
  choose_first(scaling_.scaled_bound_multipliers(near.bound_multipliers));
}

// A bound is taken where its multiplier exceeds the way to it.
void ActiveSet::choose_first(const VectorXd& bound_multipliers) {
  const auto choice = [](double value, double multiplier, double low, double high) {
    if (multiplier + (low - value) > 0) return Hold::lower;
    if (-multiplier + (value - high) > 0) return Hold::upper;
    return Hold::none;
  };
  of_variables_.assign(always_fixed_.size(), Hold::none);
  for (std::size_t i = 0; i < always_fixed_.size(); ++i)
    if (!always_fixed_[i])
      of_variables_[i] = choice(x_(i), bound_multipliers(i), p_.x_lower(i), p_.x_upper(i));
  const VectorXd values = p_.jacobian * x_;
  of_rows_.assign(kinds_.size(), Hold::none);
  for (std::size_t r = 0; r < kinds_.size(); ++r)
    if (kinds_[r] == RowKind::inequality)
      of_rows_[r] = choice(values(r), y_(r), p_.row_lower(r), p_.row_upper(r));
}

// To the optimum with the bounds of the set as equations. False where there is none.
bool ActiveSet::step() {
  const int n = p_.variables(), m = p_.rows();
  fixed_ = always_fixed_;
  for (int i = 0; i < n; ++i) {
    if (always_fixed_[i] || of_variables_[i] == Hold::lower) x_(i) = p_.x_lower(i);
    if (of_variables_[i] == Hold::upper) x_(i) = p_.x_upper(i);
    fixed_[i] = always_fixed_[i] || of_variables_[i] != Hold::none;
  }
  taken_ = kinds_;
  VectorXd right(n + m);
  right.tail(m) = -(p_.jacobian * x_);
  for (int r = 0; r < m; ++r) {
    if (kinds_[r] == RowKind::inequality)
      taken_[r] = of_rows_[r] == Hold::none ? RowKind::unbounded : RowKind::equation;
    if (taken_[r] == RowKind::unbounded)
      right(n + r) = y_(r) = 0.0;
    else
      right(n + r) += of_rows_[r] == Hold::upper ? p_.row_upper(r) : p_.row_lower(r);
  }
  right.head(n) = p_.jacobian.transpose() * y_ - p_.gradient;
  right.head(n) -= p_.hessian.selfadjointView<Eigen::Lower>() * x_;
  for (int i = 0; i < n; ++i)
    if (fixed_[i]) right(i) = 0.0;
  kkt_.set_up(p_, fixed_, taken_);
  if (!kkt_.factorise(VectorXd::Zero(n + m))) return false;
  const VectorXd solution = kkt_.solve(right);
  if (!solution.allFinite() || kkt_.error() > kSystemSolved) return false;
  x_ += solution.head(n);
  y_ -= solution.tail(m);
  return true;
}

// Towards the bounds of the set, where they cannot all be met: each is pulled at in proportion to
// what it is missed by. False where the system cannot be solved.
bool ActiveSet::soft_step() {
  const int n = p_.variables(), m = p_.rows();
  fixed_ = always_fixed_;
  taken_ = kinds_;
  VectorXd right(n + m), diagonal = VectorXd::Zero(n + m);
  right.tail(m) = -(p_.jacobian * x_);
  for (int r = 0; r < m; ++r) {
    if (kinds_[r] == RowKind::inequality && of_rows_[r] == Hold::none)
      taken_[r] = RowKind::unbounded;
    if (taken_[r] == RowKind::unbounded) {
      right(n + r) = y_(r) = 0.0;
      continue;
    }
    right(n + r) += of_rows_[r] == Hold::upper ? p_.row_upper(r) : p_.row_lower(r);
    if (taken_[r] == RowKind::equation) continue;
    diagonal(n + r) = kSoft;  // y = kSoft (bound - A x)
    right(n + r) -= y_(r) / kSoft;
  }
  right.head(n) = p_.jacobian.transpose() * y_ - p_.gradient;
  right.head(n) -= p_.hessian.selfadjointView<Eigen::Lower>() * x_;
  for (int i = 0; i < n; ++i) {
    if (always_fixed_[i]) {
      right(i) = 0.0;
    } else if (of_variables_[i] != Hold::none) {
      const double bound = of_variables_[i] == Hold::lower ? p_.x_lower(i) : p_.x_upper(i);
      diagonal(i) = kSoft;
      right(i) += kSoft * (bound - x_(i));
    }
  }
  kkt_.set_up(p_, fixed_, taken_);
  if (!kkt_.factorise(diagonal)) return false;
  const VectorXd solution = kkt_.solve(right);
  if (!solution.allFinite() || kkt_.error() > kSystemSolved) return false;
  x_ += solution.head(n);
  y_ -= solution.tail(m);
  return true;
}

// Takes bounds in that are broken and lets those go that pull.
void ActiveSet::choose_next() {
  broken_ = 0;
  changes_ = 0;
  const auto next = [&](Hold hold, double value, double multiplier, double low, double high) {
    if (hold == Hold::none) broken_ = std::max({broken_, low - value, value - high});
    if (hold == Hold::lower && multiplier >= 0) return hold;
    if (hold == Hold::upper && multiplier <= 0) return hold;
    if (hold != Hold::none) return Hold::none;
    if (value < low - kBroken) return Hold::lower;
    return value > high + kBroken ? Hold::upper : Hold::none;
  };
  const auto put = [&](Hold& hold, Hold now) {
    changes_ += hold != now;
    hold = now;
  };
  VectorXd left = p_.gradient - p_.jacobian.transpose() * y_;
  left += p_.hessian.selfadjointView<Eigen::Lower>() * x_;
  for (std::size_t i = 0; i < always_fixed_.size(); ++i)
    if (!always_fixed_[i])
      put(of_variables_[i], next(of_variables_[i], x_(i), left(i), p_.x_lower(i), p_.x_upper(i)));
  const VectorXd values = p_.jacobian * x_;
  for (std::size_t r = 0; r < kinds_.size(); ++r)
    if (kinds_[r] == RowKind::inequality)
      put(of_rows_[r], next(of_rows_[r], values(r), y_(r), p_.row_lower(r), p_.row_upper(r)));
}

// In the numbers of the problem, where it is as exact as asked.
std::optional<QuadraticResult> ActiveSet::result(const QuadraticProgram& problem,
                                                 double tolerance) const {
  QuadraticResult found;
  found.x = scaling_.unscaled_x(x_);
  found.row_multipliers = scaling_.unscaled_row_multipliers(y_);
  VectorXd left = problem.gradient - problem.jacobian.transpose() * found.row_multipliers;
  for (int i = 0; i < problem.variables(); ++i) {
    if (always_fixed_[i] || of_variables_[i] == Hold::lower) found.x(i) = problem.x_lower(i);
    if (of_variables_[i] == Hold::upper) found.x(i) = problem.x_upper(i);
  }
  left += problem.hessian.selfadjointView<Eigen::Lower>() * found.x;
  found.bound_multipliers = VectorXd::Zero(problem.variables());
  for (int i = 0; i < problem.variables(); ++i)
    if (fixed_[i]) found.bound_multipliers(i) = left(i);
  const QuadraticResiduals r =
      residuals(problem, found.x, found.row_multipliers, found.bound_multipliers);
  if (!r.within(tolerance)) return {};
  found.primal_residual = r.primal;
  found.dual_residual = r.dual;
  found.gap = r.gap;
  found.status = QuadraticStatus::optimal;
  return found;
}

}  // namespace lapwing
