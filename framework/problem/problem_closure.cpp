// SPDX-License-Identifier: Apache-2.0
// A periodic flight: the last stage closes onto the first.
//
//   x_last - x_first = 0      for every state; of yaw 2 pi times the turns
//   log(q_first^-1 q_last) = 0   for orientations
#include <numbers>

#include "framework/problem/trajectory_problem_impl.h"

namespace lapwing {
namespace {

double turned(const BlockSpec& block, const Horizon& horizon) {
  return block.name == "yaw" ? 2 * std::numbers::pi * horizon.turns : 0.0;
}

}  // namespace

void TrajectoryProblem::Impl::list_closure() {
  if (!columns.horizon.periodic) return;
  for (const BoundModel& model : columns.models)
    closed_blocks.insert(closed_blocks.end(), model.state_blocks.begin(), model.state_blocks.end());
}

int TrajectoryProblem::Impl::closure_rows() const {
  int rows_needed = 0;
  for (const int b : closed_blocks) rows_needed += columns.layout.block(b).tangent_size();
  return rows_needed;
}

void TrajectoryProblem::Impl::each_closure_entry(const std::function<void(int, int)>& visit) const {
  int row = closure_row;
  for (const int b : closed_blocks) {
    const BlockSpec& block = columns.layout.block(b);
    const int first = columns.layout.tangent_offset(b), t = block.tangent_size();
    for (int r = 0; r < t; ++r, ++row)
      for (const int stage : {0, columns.horizon.stages - 1})
        for (int i = 0; i < t; ++i)
          if (block.topology == Topology::quaternion || i == r)
            visit(row, columns.column(stage, first + i));
  }
}

void TrajectoryProblem::Impl::each_closure_pair(const std::function<void(int, int)>& visit) const {
  for (const int b : closed_blocks) {
    if (columns.layout.block(b).topology == Topology::line) continue;
    const int first = columns.layout.tangent_offset(b), last = columns.horizon.stages - 1;
    const auto column = [&](int k) { return columns.column(k < 3 ? 0 : last, first + k % 3); };
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k <= i; ++k) visit(column(i), column(k));
  }
}

void TrajectoryProblem::Impl::closure_values(const Stages& at, double* values) const {
  const int last = columns.horizon.stages - 1;
  for (const int b : closed_blocks) {
    const BlockSpec& block = columns.layout.block(b);
    const int offset = columns.layout.offset(b);
    block_difference(block, at.col(0).data() + offset, at.col(last).data() + offset, values);
    for (int i = 0; i < block.tangent_size(); ++i) *values++ -= turned(block, columns.horizon);
  }
}

void TrajectoryProblem::Impl::closure_jacobian(const Stages& at, double* jacobian) const {
  const int last = columns.horizon.stages - 1;
  const int* slot = closure_slots.data();
  for (const int b : closed_blocks) {
    const BlockSpec& block = columns.layout.block(b);
    const int offset = columns.layout.offset(b), t = block.tangent_size();
    const DifferenceJacobians d =
        difference_jacobians(block, at.col(0).data() + offset, at.col(last).data() + offset);
    for (int r = 0; r < t; ++r)
      for (const auto* side : {&d.from, &d.to})
        for (int i = 0; i < t; ++i)
          if (block.topology == Topology::quaternion || i == r) jacobian[*slot++] = (*side)(r, i);
  }
}

void TrajectoryProblem::Impl::closure_curvature(const Stages& at, const double* multipliers,
                                                double* hessian) const {
  const int last = columns.horizon.stages - 1;
  const int* slot = closure_hessian_slots.data();
  const double* lambda = multipliers + closure_row;
  for (const int b : closed_blocks) {
    const BlockSpec& block = columns.layout.block(b);
    const int offset = columns.layout.offset(b);
    if (block.topology == Topology::quaternion) {
      const Eigen::MatrixXd bend = difference_curvature(block, at.col(0).data() + offset,
                                                        at.col(last).data() + offset, lambda);
      for (int i = 0; i < 6; ++i)
        for (int k = 0; k <= i; ++k) hessian[*slot++] += bend(i, k);
    }
    lambda += block.tangent_size();
  }
}

std::string TrajectoryProblem::Impl::closure_row_name(int inside) const {
  for (const int b : closed_blocks) {
    const BlockSpec& block = columns.layout.block(b);
    if (inside < block.tangent_size()) return "closure." + component_name(block, inside);
    inside -= block.tangent_size();
  }
  return "closure";
}

}  // namespace lapwing
