// SPDX-License-Identifier: Apache-2.0
// What a TrajectoryProblem holds. Internal to the room.
#pragma once

#include <functional>

#include "framework/problem/bound_function.h"
#include "framework/problem/sparse_pattern.h"
#include "framework/problem/trajectory_problem.h"

namespace lapwing {

struct CostEntry {
  std::string name;
  double weight = 0;
  std::unique_ptr<CostTerm> term;
  std::unique_ptr<BoundFunction> bound;
  std::vector<int>
      hessian_slots;  // [instances][width (width + 1) / 2], lower triangle; -1 for none
};

struct ConstraintEntry {
  std::string name;
  std::unique_ptr<Constraint> constraint;
  std::unique_ptr<BoundFunction> bound;
  bool is_bounds = false;  // its rows are bounds on columns, not rows of the problem
  int first_row = 0;
  std::vector<double> lower, upper;
  std::vector<int> jacobian_slots;  // [instances][rows][width]; -1 for none
  std::vector<int> hessian_slots;
};

// A bound on a column and who set it.
struct ColumnBound {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  int lower_owner = -1, upper_owner = -1;  // index into bound_owners
};

struct BlockGuess {
  std::string block;
  std::vector<double> times;
  std::vector<Eigen::VectorXd> values;
};

struct TrajectoryProblem::Impl {
  Vehicle vehicle;
  Environment environment;
  StageColumns columns;
  std::vector<CostEntry> costs;
  std::vector<ConstraintEntry> constraints;
  std::vector<ColumnBound> bounds;
  std::vector<std::string> bound_owners;
  std::vector<BlockGuess> guesses;
  BlockGuess path_positions, path_yaws;
  Trajectory motion;  // to begin from; empty: the path
  Horizon motion_legs;
  Sample motion_sample(int stage) const;
  Stages before;  // continued solution: guesses of the first stages
  int held = 0;   // stages of it that do not change
  bool finished = false;
  bool rests = true;        // every model can
  bool affine_rows = true;  // all rows affine
  bool quadratic = true;    // and all residuals too
  int dynamics_rows = 0;    // model rows, held last inputs, clock
  int rows = 0;
  std::vector<int> model_slots;    // ModelStep::jacobian entries, [model][stage][row][column]
  std::vector<int> fixed_slots;    // held last inputs, then the clock
  std::vector<int> closed_blocks;  // states that the last stage of a periodic flight repeats
  std::vector<int> closure_slots, closure_hessian_slots;  // problem_closure.cpp
  int closure_row = 0;
  std::vector<int> model_hessian_slots;  // lower triangles over curvature_columns, [model][stage]
  SparseMatrix hessian_pattern, jacobian_pattern;
  std::vector<double> constant_hessian;  // values of costs whose Jacobian never changes

  // trajectory_problem.cpp
  void expect_unfinished() const;
  void add_clock();
  void bind_terms();
  void take_bounds(ConstraintEntry& entry, int owner);
  void tighten(int column, double lower, double upper, int owner);
  // problem_start.cpp
  void hold_stages();
  static void release_rows(ConstraintEntry& entry, const std::vector<bool>& decided);
  void begin_as_before(Stages& guess) const;
  void model_bounds();
  // problem_pattern.cpp
  void build_patterns(const Impl* like);
  bool constant_flow(const BoundModel& model) const;  // its Jacobian never changes
  void add_gauss_newton(const CostEntry& cost, const double* jacobian, double* values) const;
  // problem_evaluation.cpp
  void dynamics_values(const Stages& at, double* values) const;
  void dynamics_jacobian(const Stages& at, double* values, double* jacobian) const;
  void dynamics_curvature(const Stages& at, const double* multipliers, double* hessian) const;
  void add_cost_model(const CostEntry& cost, const Stages& at, bool exact, LocalModel& model,
                      Workspace& workspace) const;
  void constraint_values(const Stages& at, double* values, Workspace& workspace) const;
  double stage_number(const Stages& at, int column) const;
  // problem_closure.cpp
  void list_closure();
  int closure_rows() const;
  // visit(row, column): rows are differences of the last stage from the first.
  void each_closure_entry(const std::function<void(int, int)>& visit) const;
  void each_closure_pair(const std::function<void(int, int)>& visit) const;  // of orientations
  void closure_values(const Stages& at, double* values) const;
  void closure_jacobian(const Stages& at, double* jacobian) const;
  void closure_curvature(const Stages& at, const double* multipliers, double* hessian) const;
  std::string closure_row_name(int inside) const;
  // The clock's rows: t_{i+1} = t_i + h_i for every interval, h_{i+1} = h_i inside a free leg.
  struct ClockRow {
    int stage = 0;
    bool step = false;
  };
  std::vector<ClockRow> clock;
  // problem_names.cpp
  std::string dynamics_row_name(int row) const;
};

// The rows of one model between two neighbouring stages: x_{i+1} minus f(x_i, u_i, h_i).
struct ModelStep {
  Eigen::VectorXd values;  // state tangents
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
      jacobian;  // state tangents x (tangents of state and input, step, next state's tangents)
};
void evaluate_model_step(const StageColumns& columns, const BoundModel& model, const Stages& at,
                         int stage, bool derivatives, ModelStep& result);
// Global columns of ModelStep::jacobian.
std::vector<int> model_step_columns(const StageColumns& columns, const BoundModel& model,
                                    int stage);
// Columns in which the rows of one model step bend: those of the flow's arguments, and with
// quaternions all.
std::vector<int> curvature_columns(const StageColumns& columns, const BoundModel& model, int stage);

}  // namespace lapwing
