// SPDX-License-Identifier: Apache-2.0
// The trajectory problem (thesis 3.5):
//
//   minimise    sum_k  w_k  sum_i  || r_k(x_i, ..., x_{i+q}) ||^2     cost terms
//   subject to  x_{i+1} = f(x_i, u_i, h_i)                             vehicle models
//               lower <= g_c(x_i, ..., x_{i+q}) <= upper               constraints
//               x_min <= x <= x_max                                    bounds
//
// Build it: models, free blocks, costs, constraints, guesses; then `finish`, which binds every term
// and computes all sparsity once. From then on it is const, and all evaluation is thread-safe as
// long as each thread has an Evaluation of its own.
//
// Blocks `time` and `step` are always there: constants with a fixed step; with a free one,
// variables chained by t_{i+1} = t_i + h_i and h_{i+1} = h_i. The last stage's inputs move nothing
// and equal those before. A free block named `target` becomes the target of the trajectory's
// samples.
//
// Points are `Stages`: one column per stage, blocks at StageLayout offsets. Steps are taken in the
// tangent space, one *column* of the solver's matrices per number that is not constant.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "framework/problem/constraint.h"
#include "framework/problem/cost_term.h"
#include "framework/problem/vehicle_model.h"

namespace lapwing {

using Stages = Eigen::MatrixXd;  // stage size x number of stages
using SparseMatrix = Eigen::SparseMatrix<double>;

// Of the Hessian: J'J of the terms; that and the convex part of every constraint's own second
// derivatives, so that the model stays convex; or all second derivatives of the Lagrangian.
enum class Curvature { gauss_newton, convex, exact };

// The local model: cost ~ value + g'd + d'Hd/2, rows lower <= c + A d <= upper, x_min <= x+d <=
// x_max.
struct LocalModel {
  double cost = 0;
  Eigen::VectorXd gradient;  // columns
  SparseMatrix hessian;      // columns x columns, lower triangle
  Eigen::VectorXd values;    // rows: c
  SparseMatrix jacobian;     // rows x columns
  Eigen::VectorXd row_lower, row_upper;
  Eigen::VectorXd step_lower, step_upper;  // x_min - x, x_max - x
};

struct TermCost {
  std::string name;
  double cost = 0;  // weighted
  double unweighted = 0;
};

struct Violation {
  std::string name;   // "speed_limit", "quadrotor"
  std::string row;    // "speed_limit.x at 3.4 s"
  double amount = 0;  // in the constraint's own unit, >= 0
  double time = 0;    // s
};

class TrajectoryProblem {
 public:
  TrajectoryProblem(Vehicle vehicle, Horizon horizon, Environment environment = {});
  ~TrajectoryProblem();
  TrajectoryProblem(TrajectoryProblem&&) noexcept;

  // -- building -----------------------------------------------------------------------------------
  // With the model's own conditions, as constraints named after both.
  void add_model(std::string name, std::unique_ptr<VehicleModel> model);
  void add_block(BlockSpec block);  // role free
  void add_cost(std::string name, double weight, std::unique_ptr<CostTerm> term);
  void add_constraint(std::string name, std::unique_ptr<Constraint> constraint);
  // Initial guess: samples in time, linear in between, constant outside; velocities, accelerations
  // and inputs follow from it through the models' from_sample.
  void set_path_guess(std::vector<double> times, std::vector<Eigen::Vector3d> positions,
                      std::vector<double> yaws);
  // The motion of a solution, leg by leg: what stands at a share of a leg there stands at the same
  // share of it here. `legs` is that solution's horizon, with as many legs as this one; Error else.
  void set_motion_guess(Trajectory motion, Horizon legs);
  void set_block_guess(const std::string& block, std::vector<double> times,
                       std::vector<Eigen::VectorXd> values);
  // Continues another problem's solution: the flight before the last of the first `held` stages is
  // that of `before`, whose columns are stages of the same layout, the first one the first stage
  // here. States follow from the held inputs; the state of stage held - 1 is the last that is held,
  // its inputs are free. Every column of `before` is a guess. Call it after all blocks were added.
  // InputError where the layout differs, where there are fewer columns than `held`, or where a held
  // block is an orientation.
  void continue_from(Stages before, int held);
  // Binds all terms. InputError naming the term when one does not fit. The sparsity of `like` is
  // taken over where it is the same, which saves most of the time and changes nothing else.
  void finish(const TrajectoryProblem* like = nullptr);

  // -- what there is
  // --------------------------------------------------------------------------------
  const Vehicle& vehicle() const;
  bool rests() const;  // whether the models that it has so far can stand still
  const Horizon& horizon() const;
  const Environment& environment() const;
  const StageLayout& layout() const;
  int columns() const;
  int rows() const;           // dynamics first, then constraints that are not bounds
  int dynamics_rows() const;  // the first ones: flow, held inputs, clock
  bool quadratic() const;     // every residual affine, every row affine
  std::string column_name(int column) const;  // "position.x at 3.2 s"
  std::string row_name(int row) const;        // "camera_angle at 5.7 s"
  // "input_limits: force.x at 3.2 s", the bound on a column with who set it.
  std::string bound_name(int column, bool lower) const;
  // The bounds on a column, infinite where there is none.
  std::pair<double, double> bounds(int column) const;
  double time(const Stages& at, int stage) const;

  // -- points
  // ---------------------------------------------------------------------------------------
  Stages initial_guess() const;  // the same for every solver
  // The point of another trajectory, to begin from: what stands at a share of its time stands at
  // the same share here. Blocks that it says nothing of, and the clock, are the initial guess's.
  Stages point_of(const Trajectory& trajectory) const;
  Stages retract(const Stages& at, const Eigen::VectorXd& step) const;
  // The same first state, inputs and free blocks, flown: every later state follows through the
  // models' flows, the last inputs equal those before, and the clock runs with the first step.
  // Meets every dynamics row to rounding.
  Stages simulate(const Stages& at) const;
  Trajectory trajectory(const Stages& at) const;

  // -- evaluation
  // -----------------------------------------------------------------------------------
  double cost(const Stages& at) const;
  std::vector<TermCost> term_costs(const Stages& at) const;
  // Row values c, as in LocalModel.
  Eigen::VectorXd row_values(const Stages& at) const;
  // Fills `model`; its sparsity is the same at every call. `multipliers` (one per row)
  // weigh the curvature of rows: H += sum multipliers_r d2 c_r; without them there is none.
  void linearise(const Stages& at, LocalModel& model, Curvature curvature = Curvature::gauss_newton,
                 const Eigen::VectorXd* multipliers = nullptr) const;
  // Per leg, the worst over its intervals of the distance between the next stage and where many
  // small steps of the models lead, as a share of what a certificate allows: 1 mm, 1 cm/s, 0.2
  // degrees, 2 degrees/s. What has another unit does not count.
  std::vector<double> leg_defects(const Stages& at) const;
  // Where a solver could not go on: the function of a script that has no finite derivative at that
  // point, in words with its place, time and what to write instead; empty for none.
  std::string script_fault(const Stages& at) const;
  // Worst violation of every constraint, model and bound by name; largest first.
  std::vector<Violation> violations(const Stages& at) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapwing
