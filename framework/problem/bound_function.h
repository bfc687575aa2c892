// SPDX-License-Identifier: Apache-2.0
// A stage function inside a problem: which instances it has, how their inputs are gathered from the
// stages, and what its Jacobian is with respect to the solver's columns. Internal to the room.
//
// A *plain* instance reads whole stages. A *sampled* one (FunctionShape::times) reads the
// trajectory between two stages: states off the model's flow, inputs as held, free blocks linearly;
// the chain rule through the flow happens here, so that no term knows a vehicle model.
#pragma once

#include <string>
#include <vector>

#include "framework/problem/stage_columns.h"

namespace lapwing {

class BoundFunction {
 public:
  // Binds `function` (kept by reference). InputError naming `name` when its shape is inconsistent.
  BoundFunction(std::string name, StageFunction& function, const StageColumns& columns,
                const ProblemSetting& setting);

  const std::string& name() const { return name_; }
  const FunctionShape& shape() const { return shape_; }
  StageFunction& function() const { return *function_; }
  int instances() const { return static_cast<int>(stage_.size()); }
  int rows() const { return shape_.rows; }
  int width() const { return width_; }  // columns of one instance
  bool constant_jacobian() const { return !constant_.empty(); }
  // Whether it bends in the solver's columns.
  bool curved() const { return instances() > 0 && !constant_jacobian(); }
  // Global columns of an instance, -1 for constants.
  const int* columns(int instance) const { return columns_.data() + instance * width_; }
  int stage(int instance) const { return stage_[instance]; }
  double time(const Stages& at, int instance) const;
  // "name.x at 3.2 s"
  std::string row_name(int instance, int row) const;

  // values [instances][rows]. With `jacobian`, returns [instances][rows][width]: the constant one,
  // or computed into `jacobian` (which has that size); else null. With `integral` shapes, values
  // and Jacobian are already multiplied by the root of the step.
  const double* evaluate(const StageColumns& columns, const Stages& at, double* values,
                         std::vector<double>* jacobian, Workspace& workspace) const;

  // Of a function of a script: the first instance whose slope grows without bound where it stands,
  // or that has no value next to it, in words with its place in the script; empty for none.
  std::string fault_at(const StageColumns& columns, const Stages& at) const;

  // hessian [instances][width][width], written whole: sum_r multipliers_r d2 value_r.
  void curvature(const StageColumns& columns, const Stages& at, const double* multipliers,
                 std::vector<double>& hessian, Workspace& workspace) const;

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  const char* plugin_name() const;
  template <class Body>
  void guarded_call(const char* call, const Body& body) const;
  void expect_finite(const StageLayout& layout, InstanceRange range, const double* inputs,
                     const double* values, const double* derivatives) const;
  std::string fault_of(const StageLayout& layout, int instance, int row, const char* what,
                       const double* inputs) const;
  int row_without_slope(double* inputs, Workspace& workspace) const;
  void list_instances(const StageColumns& columns);
  int end_of_leg(const Horizon& horizon, double time) const;
  void list_columns(const StageColumns& columns);
  // Inputs of one instance; with `chain`, also d inputs / d columns: inputs_ x width.
  void gather(const StageColumns& columns, const Stages& at, int instance, double* inputs,
              RowMajor* chain) const;
  void gather_sampled(const StageColumns& columns, const Stages& at, int instance, double* inputs,
                      RowMajor* chain) const;
  void flow_between(const StageColumns& columns, const BoundModel& model, const Stages& at,
                    int instance, Eigen::VectorXd& between, RowMajor* derivative) const;
  void weight_rows(const StageColumns& columns, const Stages& at, int instance, double* values,
                   double* jacobian) const;
  void add_flow_curvature(const StageColumns& columns, const Stages& at, int instance,
                          const Eigen::VectorXd& slope, Eigen::Ref<RowMajor> result) const;
  void add_retraction_curvature(const StageColumns& columns, const Stages& at, int instance,
                                const Eigen::VectorXd& slope, Eigen::Ref<RowMajor> result) const;

  std::string name_;
  StageFunction* function_;
  std::string written_at_;  // by a script; else empty
  FunctionShape shape_;
  std::vector<std::string> row_names_;
  std::vector<int> stage_;       // first stage of each instance
  std::vector<double> offset_;   // s after it, 0 for plain instances
  std::vector<double> nominal_;  // s, for names
  std::vector<int> columns_;
  std::vector<double> constant_;  // Jacobian, where it never changes
  int inputs_ = 0;                // numbers gathered for an instance
  int width_ = 0;
  int time_offset_ = 0;
  bool sampled_ = false;      // some instance lies between two stages
  bool direct_ = false;       // inputs are the columns one to one
  bool step_column_ = false;  // the last column is the step that weights an integral
};

}  // namespace lapwing
