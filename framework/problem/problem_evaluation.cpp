// SPDX-License-Identifier: Apache-2.0
// Values and local models of a trajectory problem.
//
// How: an evaluation of a term gives one dense block per instance. Its entries are added to the
// value arrays of the sparse matrices through slots, which problem_pattern.cpp listed once in the
// order of the same loops. No index is searched during a solve, and the patterns never change.
//   cost w sum r^2   gradient 2 w J'r, Hessian 2 w J'J. Terms with a constant Jacobian have their
//                    part of the Hessian in `constant_hessian`, which is copied at the start.
//   curvature        `exact` adds the second derivatives of residuals and rows. `convex` adds those
//                    of the constraints' rows alone, and of each instance's block only the positive
//                    semidefinite part, so that the quadratic model stays convex.
//   bounds           on columns become limits of the step, x_min - x and x_max - x.
#include <cmath>

#include "framework/problem/convex_part.h"
#include "framework/problem/trajectory_problem_impl.h"

namespace lapwing {
namespace {

// Adds a lower-triangle block to the Hessian's values. Two columns of an instance may be the same
// one; its off-diagonal entry then counts twice on the diagonal.
void scatter(const BoundFunction& bound, const std::vector<int>& slots,
             const std::vector<double>& blocks, double* values) {
  const int width = bound.width();
  const int* slot = slots.data();
  for (int k = 0; k < bound.instances(); ++k) {
    const double* block = blocks.data() + static_cast<std::size_t>(k) * width * width;
    const int* columns = bound.columns(k);
    for (int a = 0; a < width; ++a)
      for (int b = 0; b <= a; ++b, ++slot)
        if (*slot >= 0)
          values[*slot] += (a != b && columns[a] == columns[b] ? 2.0 : 1.0) * block[a * width + b];
  }
}

bool same_pattern(const SparseMatrix& a, const SparseMatrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         a.isCompressed() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize(), b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

}  // namespace

double TrajectoryProblem::Impl::stage_number(const Stages& at, int column) const {
  const int stage = column / columns.per_stage, inside = column % columns.per_stage;
  for (int b = 0; b < columns.layout.count(); ++b)
    for (int i = 0; i < columns.layout.block(b).size; ++i)
      if (columns.layout.block(b).topology == Topology::line &&
          columns.column_in_stage[columns.layout.tangent_offset(b) + i] == inside)
        return at(columns.layout.offset(b) + i, stage);
  return 0.0;  // a tangent number of a quaternion: measured from where it stands
}

std::vector<TermCost> TrajectoryProblem::term_costs(const Stages& at) const {
  std::vector<TermCost> result;
  Workspace workspace;
  for (const CostEntry& cost : impl_->costs) {
    std::vector<double> values(cost.bound->instances() * cost.bound->rows());
    cost.bound->evaluate(impl_->columns, at, values.data(), nullptr, workspace);
    double sum = 0;
    for (const double value : values) sum += value * value;
    result.push_back({cost.name, cost.weight * sum, sum});
  }
  return result;
}

double TrajectoryProblem::cost(const Stages& at) const {
  double sum = 0;
  for (const TermCost& term : term_costs(at)) sum += term.cost;
  return sum;
}

void TrajectoryProblem::Impl::constraint_values(const Stages& at, double* values,
                                                Workspace& workspace) const {
  for (const ConstraintEntry& entry : constraints)
    if (!entry.is_bounds)
      entry.bound->evaluate(columns, at, values + entry.first_row, nullptr, workspace);
}

Eigen::VectorXd TrajectoryProblem::row_values(const Stages& at) const {
  Eigen::VectorXd values(rows());
  Workspace workspace;
  impl_->dynamics_values(at, values.data());
  impl_->constraint_values(at, values.data(), workspace);
  return values;
}

// Adds one cost to value, gradient and Hessian.
void TrajectoryProblem::Impl::add_cost_model(const CostEntry& cost, const Stages& at, bool exact,
                                             LocalModel& model, Workspace& workspace) const {
  const BoundFunction& bound = *cost.bound;
  const int m = bound.rows(), width = bound.width();
  std::vector<double> values(bound.instances() * m), computed;
  const double* j = bound.evaluate(columns, at, values.data(), &computed, workspace);
  for (int k = 0; k < bound.instances(); ++k)
    for (int r = 0; r < m; ++r) {
      const double value = values[k * m + r];
      const double* row = j + (static_cast<std::size_t>(k) * m + r) * width;
      model.cost += cost.weight * value * value;
      for (int c = 0; c < width; ++c)
        if (bound.columns(k)[c] >= 0)
          model.gradient(bound.columns(k)[c]) += 2.0 * cost.weight * value * row[c];
    }
  if (bound.constant_jacobian()) return;  // its Hessian is in constant_hessian
  add_gauss_newton(cost, j, model.hessian.valuePtr());
  if (!exact) return;
  for (double& value : values) value *= 2.0 * cost.weight;
  std::vector<double> blocks;
  bound.curvature(columns, at, values.data(), blocks, workspace);
  scatter(bound, cost.hessian_slots, blocks, model.hessian.valuePtr());
}

void TrajectoryProblem::linearise(const Stages& at, LocalModel& model, Curvature curvature,
                                  const Eigen::VectorXd* multipliers) const {
  const Impl& p = *impl_;
  Workspace workspace;
  if (!same_pattern(model.hessian, p.hessian_pattern)) model.hessian = p.hessian_pattern;
  if (!same_pattern(model.jacobian, p.jacobian_pattern)) model.jacobian = p.jacobian_pattern;
  std::copy(p.constant_hessian.begin(), p.constant_hessian.end(), model.hessian.valuePtr());
  model.cost = 0;
  model.gradient.setZero(columns());
  const bool rows_curved = curvature != Curvature::gauss_newton && multipliers != nullptr;
  const bool exact = rows_curved && curvature == Curvature::exact;
  for (const CostEntry& cost : p.costs) p.add_cost_model(cost, at, exact, model, workspace);

  model.values.resize(rows());
  double* j = model.jacobian.valuePtr();
  p.dynamics_jacobian(at, model.values.data(), j);
  if (exact) p.dynamics_curvature(at, multipliers->data(), model.hessian.valuePtr());
  model.row_lower.setZero(rows());
  model.row_upper.setZero(rows());
  for (const ConstraintEntry& entry : p.constraints) {
    if (entry.is_bounds) continue;
    std::vector<double> computed, blocks;
    const double* jacobian = entry.bound->evaluate(
        p.columns, at, model.values.data() + entry.first_row, &computed, workspace);
    for (std::size_t k = 0; k < entry.jacobian_slots.size(); ++k)
      if (entry.jacobian_slots[k] >= 0) j[entry.jacobian_slots[k]] = 0.0;
    for (std::size_t k = 0; k < entry.jacobian_slots.size(); ++k)
      if (entry.jacobian_slots[k] >= 0) j[entry.jacobian_slots[k]] += jacobian[k];
    std::copy(entry.lower.begin(), entry.lower.end(), model.row_lower.data() + entry.first_row);
    std::copy(entry.upper.begin(), entry.upper.end(), model.row_upper.data() + entry.first_row);
    if (!rows_curved || !entry.bound->curved()) continue;
    entry.bound->curvature(p.columns, at, multipliers->data() + entry.first_row, blocks, workspace);
    if (!exact) take_convex_parts(blocks, entry.bound->width());
    scatter(*entry.bound, entry.hessian_slots, blocks, model.hessian.valuePtr());
  }
  model.step_lower.resize(columns());
  model.step_upper.resize(columns());
  for (int c = 0; c < columns(); ++c) {
    const double number = p.stage_number(at, c);
    model.step_lower(c) = p.bounds[c].lower - number;
    model.step_upper(c) = p.bounds[c].upper - number;
  }
}

}  // namespace lapwing
