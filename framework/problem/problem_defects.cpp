// SPDX-License-Identifier: Apache-2.0
// How far the steps of a solution lead from what many smaller ones would do.
#include <cmath>
#include <numbers>

#include "framework/problem/trajectory_problem_impl.h"

namespace lapwing {
namespace {

constexpr int kFine = 8;  // steps in place of one

double allowed(const BlockSpec& block) {
  constexpr double kDegree = std::numbers::pi / 180;
  if (block.topology == Topology::quaternion || block.unit == "rad") return 0.2 * kDegree;
  if (block.unit == "rad/s") return 2 * kDegree;
  if (block.unit == "m/s") return 1e-2;
  if (block.unit == "m") return 1e-3;
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<double> TrajectoryProblem::leg_defects(const Stages& at) const {
  const StageColumns& columns = impl_->columns;
  const StageLayout& layout = columns.layout;
  std::vector<double> worst(columns.horizon.leg_count(), 0.0);
  Workspace workspace;
  for (const BoundModel& model : columns.models) {
    std::vector<double> x(model.arguments()), next(model.states);
    for (int i = 0; i + 1 < columns.horizon.stages; ++i) {
      columns.gather_model(model, at, i, columns.step(at, i) / kFine, x.data());
      for (int k = 0; k < kFine; ++k) {
        model.flow(x.data(), next.data(), nullptr, workspace);
        std::copy(next.begin(), next.end(), x.begin());
      }
      const double* reached = next.data();
      for (const int b : model.state_blocks) {
        const BlockSpec& block = layout.block(b);
        Eigen::VectorXd off(block.tangent_size());
        block_difference(block, reached, at.col(i + 1).data() + layout.offset(b), off.data());
        double& leg = worst[columns.horizon.leg_of(i)];
        leg = std::max(leg, off.norm() / allowed(block));
        reached += block.size;
      }
    }
  }
  return worst;
}

}  // namespace lapwing
