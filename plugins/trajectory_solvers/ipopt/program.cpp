#include "plugins/trajectory_solvers/ipopt/program.h"

namespace lapwing {

using Eigen::VectorXd;

Program::Program(const TrajectoryProblem& problem, Stages reference, bool exact)
    : problem_(problem), reference_(std::move(reference)), at_(reference_), exact_(exact) {
  problem_.linearise(reference_, reference_model_);
}

void Program::move_to(const double* x) {
  at_ = problem_.retract(reference_, Eigen::Map<const VectorXd>(x, variables()));
  cost_known_ = rows_known_ = linear_known_ = false;
}

double Program::cost() {
  if (!cost_known_) cost_ = problem_.cost(at_);
  cost_known_ = true;
  return cost_;
}

const VectorXd& Program::row_values() {
  if (!rows_known_) row_values_ = problem_.row_values(at_);
  rows_known_ = true;
  return row_values_;
}

const LocalModel& Program::linear() {
  if (!linear_known_) problem_.linearise(at_, linear_);
  linear_known_ = true;
  return linear_;
}

void Program::hessian(double factor, const double* multipliers, double* values) {
  const auto count = linear().hessian.nonZeros();
  Eigen::Map<VectorXd> result(values, count);
  if (!exact_) {
    result = factor * Eigen::Map<const VectorXd>(linear_.hessian.valuePtr(), count);
    return;
  }
  const Eigen::Map<const VectorXd> lambda(multipliers, rows());
  if (factor != 0) {
    const VectorXd relative = lambda / factor;
    problem_.linearise(at_, curved_, Curvature::exact, &relative);
    result = factor * Eigen::Map<const VectorXd>(curved_.hessian.valuePtr(), count);
    return;
  }
  // Ipopt restores feasibility: the rows alone, which are what their multipliers change.
  const VectorXd all = lambda, none = VectorXd::Zero(rows());
  problem_.linearise(at_, curved_, Curvature::exact, &all);
  problem_.linearise(at_, straight_, Curvature::exact, &none);
  result = Eigen::Map<const VectorXd>(curved_.hessian.valuePtr(), count) -
           Eigen::Map<const VectorXd>(straight_.hessian.valuePtr(), count);
}

}  // namespace lapwing
