// SPDX-License-Identifier: Apache-2.0
// The rows that the kernel makes itself: dynamics, held last inputs, the clock.
//
// How: a dynamics row is the difference between the state that the model's flow f reaches from
// stage i and the state of stage i + 1: x_{i+1} - f on a line, log(f^-1 q_{i+1}) for an
// orientation. With C the Jacobian of the flow's arguments in the columns (argument_chain), P the
// projection of a reached quaternion to its tangent, and D_f, D_x the Jacobians of the difference,
// the derivatives are
//
//   with respect to stage i       D_f P (df/darguments) C
//   with respect to stage i + 1   D_x
//
// The curvature of lambda' row has up to three parts: that of the flow, C' H C; that of a
// quaternion moved by its tangent (add_retraction_curvature); that of the logarithm
// (add_difference_curvature). A model that is affine, on lines and with a fixed step has one
// Jacobian for all stages.
#include "framework/problem/trajectory_problem_impl.h"

namespace lapwing {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Coefficient by coefficient: these matrices are too small for Eigen's blocked product, which is
// also the slowest thing to compile.
RowMajor product(
    const Eigen::Ref<const RowMajor, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>& a,
    const Eigen::Ref<const RowMajor, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>& b) {
  return a.lazyProduct(b);
}

// d (rotation step of q) / d q, the left inverse of the retraction's Jacobian: tangent x size.
Eigen::MatrixXd tangent_projection(const BlockSpec& block, const double* at) {
  const Eigen::MatrixXd jacobian = retraction_jacobian(block, at);
  if (block.topology == Topology::line) return jacobian;
  return 4.0 * jacobian.transpose();
}

// d arguments of a model's flow / d tangents of state and input, and the step: square but for
// quaternions.
RowMajor argument_chain(const StageColumns& columns, const BoundModel& model, const Stages& at,
                        int stage) {
  const StageLayout& layout = columns.layout;
  const int width = static_cast<int>(columns.model_columns(model, stage).size());
  RowMajor chain = RowMajor::Zero(model.arguments(), width);
  int row = 0, column = 0;
  for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
    for (const int b : *blocks) {
      const BlockSpec& block = layout.block(b);
      chain.block(row, column, block.size, block.tangent_size()) =
          retraction_jacobian(block, at.col(stage).data() + layout.offset(b));
      row += block.size;
      column += block.tangent_size();
    }
  chain(row, column) = 1.0;
  return chain;
}

// A quaternion moved by d is q + E d - |d|^2 q / 8 + ...: curvature of its own, where `slope` is
// the derivative of the bent quantity with respect to the flow's arguments.
void add_retraction_curvature(const StageColumns& columns, const BoundModel& model,
                              const Stages& at, int stage, const Eigen::VectorXd& slope,
                              RowMajor& hessian) {
  int row = 0, column = 0;
  for (const int b : model.state_blocks) {
    const BlockSpec& block = columns.layout.block(b);
    if (block.topology == Topology::quaternion)
      hessian.diagonal().segment<3>(column).array() -=
          0.25 * at.col(stage).segment<4>(columns.layout.offset(b)).dot(slope.segment<4>(row));
    row += block.size;
    column += block.tangent_size();
  }
}

// Curvature of a quaternion's row in the flow's tangent, which moves by `flow` times the arguments'
// tangents, and in the next stage's, which stands at `next` among the columns. Lower triangle.
void add_difference_curvature(const Eigen::MatrixXd& curvature, const RowMajor& flow,
                              Eigen::Index next, RowMajor& hessian) {
  const Eigen::Index width = flow.cols();
  hessian.topLeftCorner(width, width) +=
      product(flow.transpose(), product(curvature.topLeftCorner(3, 3), flow));
  hessian.block(next, 0, 3, width) += product(curvature.bottomLeftCorner(3, 3), flow);
  hessian.block<3, 3>(next, next) += curvature.bottomRightCorner<3, 3>();
}

// Whether the model's blocks are all plain numbers.
bool straight(const StageLayout& layout, const BoundModel& model) {
  for (const auto* blocks : {&model.state_blocks, &model.input_blocks})
    for (const int b : *blocks)
      if (layout.block(b).topology == Topology::quaternion) return false;
  return true;
}

}  // namespace

std::vector<int> curvature_columns(const StageColumns& columns, const BoundModel& model,
                                   int stage) {
  return straight(columns.layout, model) ? columns.model_columns(model, stage)
                                         : model_step_columns(columns, model, stage);
}

void evaluate_model_step(const StageColumns& columns, const BoundModel& model, const Stages& at,
                         int stage, bool derivatives, ModelStep& result) {
  const StageLayout& layout = columns.layout;
  std::vector<double> x(model.arguments()), next(model.states);
  RowMajor jacobian;
  if (derivatives) jacobian.resize(model.states, model.arguments());
  columns.gather_model(model, at, stage, columns.step(at, stage), x.data());
  Workspace workspace;
  model.flow(x.data(), next.data(), derivatives ? jacobian.data() : nullptr, workspace);
  result.values.resize(model.state_tangents);
  RowMajor flow;
  if (derivatives) {
    flow = jacobian.lazyProduct(argument_chain(columns, model, at, stage));
    result.jacobian.setZero(model.state_tangents, flow.cols() + model.state_tangents);
  }
  int row = 0, state = 0;
  for (const int b : model.state_blocks) {
    const BlockSpec& block = layout.block(b);
    const int t = block.tangent_size();
    const double* there = at.col(stage + 1).data() + layout.offset(b);
    block_difference(block, next.data() + state, there, result.values.data() + row);
    if (derivatives) {
      const DifferenceJacobians d = difference_jacobians(block, next.data() + state, there);
      result.jacobian.block(row, 0, t, flow.cols()) =
          product(product(d.from, tangent_projection(block, next.data() + state)),
                  flow.middleRows(state, block.size));
      result.jacobian.block(row, flow.cols() + row, t, t) = d.to;
    }
    row += t;
    state += block.size;
  }
}

Stages TrajectoryProblem::simulate(const Stages& at) const {
  const StageColumns& columns = impl_->columns;
  const StageLayout& layout = columns.layout;
  const int last = columns.horizon.stages - 1;
  const int time = layout.offset(columns.time_block), step = layout.offset(columns.step_block);
  Stages flown = at;
  Workspace workspace;
  for (int i = 0; i < last; ++i) {
    if (columns.horizon.step_free) {
      if (columns.horizon.chained(i)) flown(step, i + 1) = flown(step, i);
      flown(time, i + 1) = flown(time, i) + flown(step, i);
    }
    for (const BoundModel& model : columns.models) {
      std::vector<double> x(model.arguments()), next(model.states);
      columns.gather_model(model, flown, i, columns.step(flown, i), x.data());
      model.flow(x.data(), next.data(), nullptr, workspace);
      const double* from = next.data();
      for (const int b : model.state_blocks) {
        const BlockSpec& block = layout.block(b);
        auto there = flown.col(i + 1).segment(layout.offset(b), block.size);
        there = Eigen::Map<const Eigen::VectorXd>(from, block.size);
        if (block.topology == Topology::quaternion) there.normalize();
        from += block.size;
      }
      if (i + 1 < last) continue;
      for (const int b : model.input_blocks)
        flown.col(last).segment(layout.offset(b), layout.block(b).size) =
            flown.col(i).segment(layout.offset(b), layout.block(b).size);
    }
  }
  return flown;
}

void TrajectoryProblem::Impl::dynamics_values(const Stages& at, double* values) const {
  const int stages = columns.horizon.stages;
  ModelStep step;
  double* out = values;
  for (const BoundModel& model : columns.models) {
    for (int i = 0; i + 1 < stages; ++i, out += model.state_tangents) {
      evaluate_model_step(columns, model, at, i, false, step);
      std::copy_n(step.values.data(), model.state_tangents, out);
    }
    for (const int b : model.input_blocks)
      for (int k = 0; k < columns.layout.block(b).size; ++k) {
        const int row = columns.layout.offset(b) + k;
        *out++ = at(row, stages - 1) - at(row, stages - 2);
      }
  }
  closure_values(at, values + closure_row);
  if (!columns.horizon.step_free) return;
  const int time = columns.layout.offset(columns.time_block);
  const int length = columns.layout.offset(columns.step_block);
  for (const ClockRow& row : clock) {
    const int i = row.stage;
    *out++ = row.step ? at(length, i + 1) - at(length, i)
                      : at(time, i + 1) - at(time, i) - at(length, i);
  }
}

void TrajectoryProblem::Impl::dynamics_jacobian(const Stages& at, double* values,
                                                double* jacobian) const {
  const int stages = columns.horizon.stages;
  const int* slot = model_slots.data();
  ModelStep step;
  dynamics_values(at, values);
  for (const BoundModel& model : columns.models) {
    // One Jacobian serves all stages where it is constant.
    const bool constant = constant_flow(model);
    for (int i = 0; i + 1 < stages; ++i) {
      if (i == 0 || !constant || columns.step(at, i) != columns.step(at, i - 1))
        evaluate_model_step(columns, model, at, i, true, step);
      for (Eigen::Index k = 0; k < step.jacobian.size(); ++k, ++slot)
        if (*slot >= 0) jacobian[*slot] = step.jacobian.data()[k];
    }
  }
  const int* fixed = fixed_slots.data();
  for (const BoundModel& model : columns.models)
    for (int k = 0; k < model.inputs; ++k) {
      jacobian[*fixed++] = -1.0;
      jacobian[*fixed++] = 1.0;
    }
  closure_jacobian(at, jacobian);
  for (const ClockRow& row : clock) {
    jacobian[*fixed++] = -1.0;
    jacobian[*fixed++] = 1.0;
    if (!row.step) jacobian[*fixed++] = -1.0;
  }
}

void TrajectoryProblem::Impl::dynamics_curvature(const Stages& at, const double* multipliers,
                                                 double* hessian) const {
  const StageLayout& layout = columns.layout;
  const int* slot = model_hessian_slots.data();
  closure_curvature(at, multipliers, hessian);
  Workspace workspace;
  for (const BoundModel& model : columns.models) {
    if (model.model->affine() && !columns.horizon.step_free) continue;
    const int n = model.arguments();
    std::vector<double> x(n), next(model.states);
    RowMajor jacobian(model.states, n), bend(n, n), tangent;
    const bool lines = straight(layout, model);
    for (int i = 0; i + 1 < columns.horizon.stages; ++i) {
      columns.gather_model(model, at, i, columns.step(at, i), x.data());
      if (lines) {  // the row is the next state minus the flow
        const Eigen::VectorXd ambient = -Eigen::Map<const Eigen::VectorXd>(
            multipliers + model.first_row + i * model.state_tangents, model.states);
        bend.setZero();
        model.curvature(x.data(), ambient.data(), bend.data(), workspace);
        for (int a = 0; a < n; ++a)
          for (int b = 0; b <= a; ++b, ++slot)
            if (*slot >= 0) hessian[*slot] += bend(a, b);
        continue;
      }
      model.flow(x.data(), next.data(), jacobian.data(), workspace);
      const RowMajor chain = argument_chain(columns, model, at, i);
      const auto width = chain.cols();
      const auto all = static_cast<Eigen::Index>(curvature_columns(columns, model, i).size());
      tangent.setZero(all, all);
      // Multipliers of the flow's own numbers: the row is the difference from the flow.
      Eigen::VectorXd ambient(model.states);
      int row = 0, state = 0;
      for (const int b : model.state_blocks) {
        const BlockSpec& block = layout.block(b);
        const double* there = at.col(i + 1).data() + layout.offset(b);
        const DifferenceJacobians d = difference_jacobians(block, next.data() + state, there);
        const Eigen::MatrixXd projection = tangent_projection(block, next.data() + state);
        const Eigen::Map<const Eigen::VectorXd> lambda(
            multipliers + model.first_row + i * model.state_tangents + row, block.tangent_size());
        ambient.segment(state, block.size) =
            product(d.from, projection).transpose().lazyProduct(lambda);
        if (block.topology == Topology::quaternion)
          add_difference_curvature(
              difference_curvature(block, next.data() + state, there, lambda.data()),
              product(product(projection, jacobian.middleRows(state, block.size)), chain),
              width + row, tangent);
        row += block.tangent_size();
        state += block.size;
      }
      bend.setZero();
      model.curvature(x.data(), ambient.data(), bend.data(), workspace);
      tangent.topLeftCorner(width, width) += product(chain.transpose(), product(bend, chain));
      add_retraction_curvature(columns, model, at, i, jacobian.transpose().lazyProduct(ambient),
                               tangent);
      for (int a = 0; a < tangent.rows(); ++a)
        for (int b = 0; b <= a; ++b, ++slot)
          if (*slot >= 0) hessian[*slot] += tangent(a, b);
    }
  }
}

}  // namespace lapwing
