// SPDX-License-Identifier: Apache-2.0
// Where the numbers of a stage stand in the solver's columns, and how models read a stage.
// Internal to the room.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/problem/vehicle_model.h"

namespace lapwing {

using Stages = Eigen::MatrixXd;

// A vehicle model inside a problem.
struct BoundModel {
  std::string name;
  std::unique_ptr<VehicleModel> model;
  std::vector<int> state_blocks, input_blocks;  // layout indices, in the model's order
  int states = 0, inputs = 0;                   // numbers
  int state_tangents = 0;
  int first_row = 0;  // of its dynamics

  int arguments() const { return states + inputs + 1; }
  // Of one instance, told of with the plugin's name where it fails (vehicle_model.h).
  void flow(const double* arguments, double* next, double* jacobian, Workspace& workspace) const;
  void curvature(const double* arguments, const double* multipliers, double* hessian,
                 Workspace& workspace) const;
};

struct StageColumns {
  StageLayout layout;
  Horizon horizon;
  std::vector<BoundModel> models;
  std::vector<int> column_in_stage;  // per tangent number of a stage; -1 for constants
  int per_stage = 0;
  int time_block = -1, step_block = -1;

  int column(int stage, int tangent) const {
    const int inside = column_in_stage[tangent];
    return inside < 0 ? -1 : stage * per_stage + inside;
  }
  int total() const { return per_stage * horizon.stages; }
  double step(const Stages& at, int stage) const { return at(layout.offset(step_block), stage); }
  // state, input, `duration`: the arguments of the model's flow from `stage`.
  void gather_model(const BoundModel& model, const Stages& at, int stage, double duration,
                    double* arguments) const;
  // Global columns of the tangent numbers of state and input, then of the step.
  std::vector<int> model_columns(const BoundModel& model, int stage) const;
  // Converts a Jacobian with respect to a block's numbers into one with respect to its tangent.
  // `jacobian` rows have `stride` numbers and begin at the block; writes at `result` likewise.
  void to_tangent(const BlockSpec& block, const double* at, const double* jacobian, int rows,
                  int stride, double* result, int result_stride) const;
};

}  // namespace lapwing
