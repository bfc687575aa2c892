// SPDX-License-Identifier: Apache-2.0
// How: move_to moves the stages to x. Cost, rows and derivatives are computed when first asked for
// and kept until the next x. Derivatives of the local model are in the tangent at x; with
// orientations they are multiplied by B (turn_map), which is the identity but for a 3 x 3 block J
// for each of them.
//
// `linearise` gives the Hessian of cost + mu'c. That of factor * cost + lambda'c is factor times
// the one with mu = lambda / factor. While Ipopt restores feasibility the factor is 0; then it is
// the difference of two, with mu = lambda and with mu = 0.
#include "plugins/trajectory_solvers/ipopt/program.h"

#include <cmath>

namespace lapwing {
namespace {

// J of exp(x + e) = exp(x) exp(J e) for rotation vectors.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& x) {
  const double angle = x.norm(), squared = angle * angle;
  Eigen::Matrix3d cross;
  cross << 0, -x.z(), x.y(), x.z(), 0, -x.x(), -x.y(), x.x(), 0;
  const bool small = angle < 1e-3;
  const double first = small ? 0.5 - squared / 24 : (1 - std::cos(angle)) / squared;
  const double second =
      small ? 1.0 / 6 - squared / 120 : (angle - std::sin(angle)) / (squared * angle);
  return Eigen::Matrix3d::Identity() - first * cross + second * cross.lazyProduct(cross);
}

}  // namespace

using Eigen::VectorXd;

Program::Program(const TrajectoryProblem& problem, Stages reference, bool exact)
    : problem_(problem), reference_(std::move(reference)), at_(reference_), exact_(exact) {
  list_turns();
  x_ = VectorXd::Zero(variables());
  problem_.linearise(reference_, tangent_);
  into_program(tangent_, reference_model_);
}

void Program::relax(double weight) {
  relaxed_ = rows() - problem_.dynamics_rows();
  weight_ = weight;
  x_ = VectorXd::Zero(variables());
  cost_known_ = rows_known_ = linear_known_ = false;
  into_program(tangent_, reference_model_);
}

VectorXd Program::start() const {
  VectorXd x = VectorXd::Zero(variables());
  const LocalModel& model = reference_model_;
  const VectorXd values = problem_.row_values(reference_);
  for (int k = 0; k < relaxed_; ++k) {
    const int r = rows() - relaxed_ + k;
    x(columns() + k) = std::max(0.0, model.row_lower(r) - values(r));
    x(columns() + relaxed_ + k) = std::max(0.0, values(r) - model.row_upper(r));
  }
  return x;
}

void Program::list_turns() {
  const StageLayout& layout = problem_.layout();
  const int stages = problem_.horizon().stages, per_stage = problem_.columns() / stages;
  for (int stage = 0; stage < stages; ++stage)
    for (int b = 0; b < layout.count(); ++b)
      if (layout.block(b).topology == Topology::quaternion)
        turns_.push_back(stage * per_stage + layout.tangent_offset(b));
}

double Program::largest_turn() const {
  double largest = 0;
  for (const int c : turns_) largest = std::max(largest, x_.segment<3>(c).norm());
  return largest;
}

void Program::move_to(const double* x) {
  x_ = Eigen::Map<const VectorXd>(x, variables());
  at_ = problem_.retract(reference_, x_.head(columns()));
  cost_known_ = rows_known_ = linear_known_ = false;
}

double Program::cost() {
  if (!cost_known_) cost_ = weight_ * problem_.cost(at_) + x_.tail(2 * relaxed_).sum();
  cost_known_ = true;
  return cost_;
}

const VectorXd& Program::row_values() {
  if (!rows_known_) {
    row_values_ = problem_.row_values(at_);
    row_values_.tail(relaxed_) += x_.segment(columns(), relaxed_) - x_.tail(relaxed_);
  }
  rows_known_ = true;
  return row_values_;
}

const LocalModel& Program::linear() {
  if (linear_known_) return linear_;
  problem_.linearise(at_, tangent_);
  into_program(tangent_, linear_);
  linear_known_ = true;
  return linear_;
}

SparseMatrix Program::turn_map() const {
  std::vector<bool> turned(columns(), false);
  std::vector<Eigen::Triplet<double>> entries;
  for (const int c : turns_) {
    const Eigen::Matrix3d jacobian = right_jacobian(x_.segment<3>(c));
    for (int i = 0; i < 3; ++i) {
      turned[c + i] = true;
      for (int j = 0; j < 3; ++j) entries.emplace_back(c + i, c + j, jacobian(i, j));
    }
  }
  for (int c = 0; c < columns(); ++c)
    if (!turned[c]) entries.emplace_back(c, c, 1.0);
  SparseMatrix map(columns(), columns());
  map.setFromTriplets(entries.begin(), entries.end());
  return map;
}

// The patterns depend on those of the tangent model alone: products keep zeros.
void Program::into_program(const LocalModel& tangent, LocalModel& model) const {
  model = tangent;
  if (!turns_.empty()) turn(tangent, model);
  if (relaxed_ > 0) add_slacks(model);
}

void Program::turn(const LocalModel& tangent, LocalModel& model) const {
  const SparseMatrix map = turn_map();
  const SparseMatrix whole = tangent.hessian.selfadjointView<Eigen::Lower>();
  const SparseMatrix right = whole * map;
  const SparseMatrix both = SparseMatrix(map.transpose()) * right;
  model.gradient = map.transpose() * tangent.gradient;
  model.jacobian = tangent.jacobian * map;
  model.hessian = both.triangularView<Eigen::Lower>();
}

void Program::add_slacks(LocalModel& model) const {
  const int n = columns();
  const auto extend = [&](VectorXd& vector, double value) {
    vector.conservativeResize(variables());
    vector.tail(2 * relaxed_).setConstant(value);
  };
  model.gradient *= weight_;
  extend(model.gradient, 1.0);
  extend(model.step_lower, 0.0);
  extend(model.step_upper, std::numeric_limits<double>::infinity());
  model.jacobian.conservativeResize(rows(), variables());
  model.jacobian.makeCompressed();
  for (const double sign : {1.0, -1.0})
    for (int k = 0; k < relaxed_; ++k)
      model.jacobian.insert(rows() - relaxed_ + k, n + (sign > 0 ? 0 : relaxed_) + k) = sign;
  model.jacobian.makeCompressed();
}

void Program::add_hessian(double factor, const SparseMatrix& hessian, double* values) const {
  Eigen::Map<VectorXd>(values, hessian.nonZeros()) +=
      factor * Eigen::Map<const VectorXd>(hessian.valuePtr(), hessian.nonZeros());
}

void Program::hessian(double factor, const double* multipliers, double* values) {
  std::fill_n(values, linear().hessian.nonZeros(), 0.0);
  if (!exact_) return add_hessian(weight_ * factor, linear_.hessian, values);
  const VectorXd lambda = Eigen::Map<const VectorXd>(multipliers, rows());
  const auto add = [&](double share, const VectorXd& relative) {
    problem_.linearise(at_, tangent_, Curvature::exact, &relative);
    into_program(tangent_, curved_);
    add_hessian(share, curved_.hessian, values);
  };
  factor *= weight_;
  if (factor != 0) return add(factor, lambda / factor);
  // Ipopt restores feasibility: the rows alone, which are what their multipliers change.
  add(1.0, lambda);
  add(-1.0, VectorXd::Zero(rows()));
}

}  // namespace lapwing
