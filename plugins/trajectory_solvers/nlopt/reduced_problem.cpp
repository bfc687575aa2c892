// SPDX-License-Identifier: Apache-2.0
// How: the pattern of the dynamics' Jacobian is read once. The last column of each row is its
// pivot: the number that the row determines. Sorted by pivot, the rows are triangular in the
// pivots. `forward` solves J dx = 0, or J dx = -rows, by substitution from the first row to the
// last. `backward` solves the transposed system from the last row to the first, which is the
// adjoint method: the multiplier of a row cancels the gradient of its pivot. Both take the time of
// one pass over the Jacobian's entries.
#include "plugins/trajectory_solvers/nlopt/reduced_problem.h"

#include <algorithm>

namespace lapwing {

using Eigen::VectorXd;

std::string ReducedProblem::unsupported(const TrajectoryProblem& problem) {
  const StageLayout& layout = problem.layout();
  for (int b = 0; b < layout.count(); ++b)
    if (layout.block(b).topology == Topology::quaternion)
      return "nlopt does not support orientations, such as block '" + layout.block(b).name +
             "': use the solver iqp";
  if (problem.horizon().step_free)
    return "nlopt does not support free steps: its scaling needs dynamics that do not depend on "
           "the "
           "times; give every keyframe a time, or use the solver iqp or ipopt";
  if (problem.horizon().periodic)
    return "nlopt does not support periodic flights: use the solver iqp";
  return "";
}

ReducedProblem::ReducedProblem(const TrajectoryProblem& problem) : problem_(problem) {
  LocalModel model;
  problem.linearise(problem.initial_guess(), model);
  sweep_.resize(problem.dynamics_rows());
  const SparseMatrix& jacobian = model.jacobian;
  for (int c = 0; c < jacobian.outerSize(); ++c)
    for (int k = jacobian.outerIndexPtr()[c]; k < jacobian.outerIndexPtr()[c + 1]; ++k) {
      const int row = jacobian.innerIndexPtr()[k];
      if (row < problem.dynamics_rows()) sweep_[row].others.push_back({c, k});
    }
  pivot_row_.assign(problem.columns(), -1);
  for (int r = 0; r < problem.dynamics_rows(); ++r) {
    Row& row = sweep_[r];  // its columns came in order
    row.row = r;
    row.pivot = row.others.back().column;
    row.pivot_slot = row.others.back().slot;
    row.others.pop_back();
  }
  std::sort(sweep_.begin(), sweep_.end(),
            [](const Row& a, const Row& b) { return a.pivot < b.pivot; });
  for (std::size_t k = 0; k < sweep_.size(); ++k) pivot_row_[sweep_[k].pivot] = static_cast<int>(k);
  for (int c = 0; c < problem.columns(); ++c) {
    const auto [lower, upper] = problem.bounds(c);
    if (pivot_row_[c] < 0 && lower < upper) independent_.push_back(c);
  }
}

Stages ReducedProblem::fly(const Stages& from, const VectorXd& step) const {
  VectorXd all = VectorXd::Zero(problem_.columns());
  for (int k = 0; k < size(); ++k) all(independent_[k]) = step(k);
  return problem_.simulate(problem_.retract(from, all));
}

void ReducedProblem::forward(const LocalModel& model, const VectorXd& step, const VectorXd* rows,
                             VectorXd& all) const {
  all.setZero(problem_.columns());
  for (int k = 0; k < size(); ++k) all(independent_[k]) = step(k);
  const double* values = model.jacobian.valuePtr();
  for (const Row& row : sweep_) {
    double sum = rows ? (*rows)(row.row) : 0.0;
    for (const Entry& e : row.others) sum += values[e.slot] * all(e.column);
    all(row.pivot) = -sum / values[row.pivot_slot];
  }
}

void ReducedProblem::backward(const LocalModel& model, VectorXd& gradient, VectorXd& reduced,
                              VectorXd* multipliers) const {
  const double* values = model.jacobian.valuePtr();
  if (multipliers) multipliers->setZero(problem_.dynamics_rows());
  for (auto row = sweep_.rbegin(); row != sweep_.rend(); ++row) {
    const double multiplier = -gradient(row->pivot) / values[row->pivot_slot];
    gradient(row->pivot) = 0.0;
    for (const Entry& e : row->others) gradient(e.column) += multiplier * values[e.slot];
    if (multipliers) (*multipliers)(row->row) = multiplier;
  }
  reduced.resize(size());
  for (int k = 0; k < size(); ++k) reduced(k) = gradient(independent_[k]);
}

}  // namespace lapwing
