#include "plugins/trajectory_solvers/nlopt/augmented_cost.h"

#include <cmath>

namespace lapwing {
namespace {

constexpr double kEnough = 0.25;  // share of the last miss that may be left
constexpr double kRaise = 10.0;

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

void AugmentedCost::hessian_times(const LocalModel& model, const VectorXd& step,
                                  VectorXd& product) const {
  product = model.hessian.selfadjointView<Eigen::Lower>() * step;
  VectorXd rows = model.jacobian * step;
  VectorXd weighted = VectorXd::Zero(rows.size());
  for (const Limited& item : limited_) {
    if (item.error == 0) continue;
    if (item.is_row)
      weighted(item.index) = item.penalty * rows(item.index);
    else
      product(item.index) += item.penalty * step(item.index);
  }
  product += model.jacobian.transpose() * weighted;
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

void AugmentedCost::raise(double tolerance) {
  for (std::size_t k = 0; k < limited_.size(); ++k) {
    Limited& item = limited_[k];
    if (item.miss <= tolerance || item.miss <= kEnough * before_[k]) continue;
    item.penalty *= kRaise;
  }
}

}  // namespace lapwing
