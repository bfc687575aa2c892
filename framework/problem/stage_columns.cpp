// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/stage_columns.h"

namespace lapwing {

void BoundModel::flow(const double* arguments, double* next, double* jacobian,
                      Workspace& workspace) const {
  in_plugin(*model, "flow", [&] { model->flow({0, 1}, arguments, next, jacobian, workspace); });
}

void BoundModel::curvature(const double* arguments, const double* multipliers, double* hessian,
                           Workspace& workspace) const {
  in_plugin(*model, "curvature", [&] {
    model->curvature({0, 1}, arguments, multipliers, hessian, workspace);
  });
}

void StageColumns::gather_model(const BoundModel& model, const Stages& at, int stage,
                                double duration, double* arguments) const {
  for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
    for (const int block : *blocks) {
      const int size = layout.block(block).size;
      std::copy_n(at.col(stage).data() + layout.offset(block), size, arguments);
      arguments += size;
    }
  *arguments = duration;
}

std::vector<int> StageColumns::model_columns(const BoundModel& model, int stage) const {
  std::vector<int> columns;
  for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
    for (const int block : *blocks)
      for (int i = 0; i < layout.block(block).tangent_size(); ++i)
        columns.push_back(column(stage, layout.tangent_offset(block) + i));
  columns.push_back(column(stage, layout.tangent_offset(step_block)));
  return columns;
}

void StageColumns::to_tangent(const BlockSpec& block, const double* at, const double* jacobian,
                              int rows, int stride, double* result, int result_stride) const {
  if (block.topology == Topology::line) {
    for (int r = 0; r < rows; ++r)
      std::copy_n(jacobian + r * stride, block.size, result + r * result_stride);
    return;
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Stride = Eigen::OuterStride<>;
  const Eigen::Map<const RowMajor, 0, Stride> j(jacobian, rows, block.size, Stride(stride));
  Eigen::Map<RowMajor, 0, Stride> out(result, rows, block.tangent_size(), Stride(result_stride));
  out.noalias() = j * retraction_jacobian(block, at);
}

}  // namespace lapwing
