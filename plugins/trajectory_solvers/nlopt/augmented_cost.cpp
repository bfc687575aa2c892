// SPDX-License-Identifier: Apache-2.0
// How: the error e of a limited quantity is measured from its limits moved by y / rho. A quantity
// with e = 0 is inactive and adds neither gradient nor Hessian. Bounds act on their column, rows
// through the Jacobian: gradient += J' (rho e). The Gauss-Newton Hessian adds rho a a' for each
// active row a.
//
// `update` sets y = -rho e, the multiplier that makes the gradient of the Lagrangian equal to that
// of L. `raise` multiplies rho by 10 where the miss did not fall to a quarter, and by 100 where it
// hardly fell.
#include "plugins/trajectory_solvers/nlopt/augmented_cost.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

constexpr double kEnough = 0.25;  // share of the last miss that may be left
constexpr double kRaise = 10.0;
constexpr double kNone = 0.95;  // share that is no progress

}  // namespace

using Eigen::VectorXd;

AugmentedCost::AugmentedCost(const TrajectoryProblem& problem, const std::vector<int>& columns)
    : dynamics_rows_(problem.dynamics_rows()) {
  for (const int c : columns) {
    const auto [lower, upper] = problem.bounds(c);
    if (std::isfinite(lower) || std::isfinite(upper))
      limited_.push_back({.is_row = false, .index = c});
  }
  for (int r = dynamics_rows_; r < problem.rows(); ++r)
    limited_.push_back({.is_row = true, .index = r});
}

double AugmentedCost::evaluate(const LocalModel& model, VectorXd& gradient) {
  double sum = model.cost;
  gradient = model.gradient;
  weights_.setZero(model.values.size());
  for (Limited& item : limited_) {
    const int i = item.index;
    const double below = item.is_row ? model.row_lower(i) - model.values(i) : model.step_lower(i);
    const double above = item.is_row ? model.values(i) - model.row_upper(i) : -model.step_upper(i);
    const double shift = item.multiplier / item.penalty;
    item.violation = std::max({0.0, below, above});
    item.error = below + shift > 0 ? -(below + shift) : (above - shift > 0 ? above - shift : 0.0);
    if (item.error == 0) continue;
    sum += 0.5 * item.penalty * item.error * item.error;
    if (item.is_row)
      weights_(i) = item.penalty * item.error;
    else
      gradient(i) += item.penalty * item.error;
  }
  gradient += model.jacobian.transpose() * weights_;
  return sum;
}

void AugmentedCost::prepare_hessian(const LocalModel& model) {
  std::vector<int> active(model.values.size(), -1);
  active_.clear();
  for (const Limited& item : limited_) {
    if (!item.is_row || item.error == 0) continue;
    active[item.index] = static_cast<int>(active_.size());
    active_.push_back({item.penalty, {}});
  }
  for (int c = 0; c < model.jacobian.outerSize(); ++c)
    for (SparseMatrix::InnerIterator e(model.jacobian, c); e; ++e)
      if (active[e.row()] >= 0) active_[active[e.row()]].entries.push_back({c, e.value()});
  std::erase_if(active_, [](const ActiveRow& row) { return row.entries.empty(); });
}

void AugmentedCost::hessian_times(const LocalModel& model, const VectorXd& step,
                                  VectorXd& product) const {
  product = model.hessian.selfadjointView<Eigen::Lower>() * step;
  for (const Limited& item : limited_)
    if (!item.is_row && item.error != 0) product(item.index) += item.penalty * step(item.index);
  for (const ActiveRow& row : active_) {
    double change = 0;
    for (const auto& [column, value] : row.entries) change += value * step(column);
    for (const auto& [column, value] : row.entries) product(column) += row.penalty * change * value;
  }
}

double AugmentedCost::update() {
  double worst = 0;
  before_.resize(limited_.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < limited_.size(); ++k) {
    Limited& item = limited_[k];
    const double next = -item.penalty * item.error;
    before_[k] = item.miss;
    item.miss = std::abs(next - item.multiplier) / item.penalty;
    item.multiplier = next;
    worst = std::max(worst, item.miss);
  }
  return worst;
}

double AugmentedCost::worst_violation() const {
  double worst = 0;
  for (const Limited& item : limited_) worst = std::max(worst, item.violation);
  return worst;
}

double AugmentedCost::violation_energy() const {
  double sum = 0;
  for (const Limited& item : limited_) sum += 0.5 * item.penalty * item.violation * item.violation;
  return sum;
}

void AugmentedCost::raise(double tolerance) {
  for (std::size_t k = 0; k < limited_.size(); ++k) {
    Limited& item = limited_[k];
    if (item.miss <= tolerance || item.miss <= kEnough * before_[k]) continue;
    item.penalty *= item.miss > kNone * before_[k] ? kRaise * kRaise : kRaise;
  }
}

}  // namespace lapwing
