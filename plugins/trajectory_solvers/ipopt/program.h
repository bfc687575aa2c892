// SPDX-License-Identifier: Apache-2.0
// The trajectory problem as a nonlinear program for Ipopt. Free of Ipopt's types: `ipopt.cpp`
// passes them on.
//
// Its variables are the whole step x from a reference point, one number per column. On a line, that
// is the number itself, moved. An orientation turned by x from its reference answers a small change
// e of x with the small turn J(x) e in its own body frame, J the right Jacobian of the rotation
// group; so with B = diag(I, J) the program's derivatives are those of the local model times B:
//
//   gradient  B'g     Jacobian  A B     Hessian  B'H B
//
// (of the Hessian, all but a term that vanishes where the Lagrangian is stationary).
//
// The *elastic* program relaxes every row but the dynamics by p - n, p and n variables of their own
// after the columns, and asks for the least `weight` * cost + sum (p + n): what is left of the sum
// cannot be met.
#pragma once

#include "framework/problem/trajectory_problem.h"

namespace lapwing {

class Program {
 public:
  // Kept by reference. `exact`: curvature of residuals and rows too.
  Program(const TrajectoryProblem& problem, Stages reference, bool exact);
  // From here on the elastic program; `weight` > 0.
  void relax(double weight);
  bool relaxed() const { return relaxed_ > 0; }

  int columns() const { return problem_.columns(); }
  int variables() const { return columns() + 2 * relaxed_; }
  int rows() const { return problem_.rows(); }
  const LocalModel& at_reference() const { return reference_model_; }  // bounds and patterns
  // Largest turn of an orientation from its reference, in rad; J is singular at 2 pi.
  double largest_turn() const;
  const TrajectoryProblem& problem() const { return problem_; }
  const Stages& reference() const { return reference_; }

  // All at x; nothing is computed twice for one x.
  void move_to(const double* x);
  // The reference, and slacks that make up for what it misses.
  Eigen::VectorXd start() const;
  double cost();
  const Eigen::VectorXd& row_values();
  const LocalModel& linear();  // gradient and Jacobian
  // factor * cost + sum multipliers_r c_r: values in the pattern of the Hessian's lower triangle.
  void hessian(double factor, const double* multipliers, double* values);

 private:
  void list_turns();
  SparseMatrix turn_map() const;  // B at x
  void into_program(const LocalModel& tangent, LocalModel& model) const;
  void turn(const LocalModel& tangent, LocalModel& model) const;
  void add_slacks(LocalModel& model) const;
  void add_hessian(double factor, const SparseMatrix& tangent, double* values) const;

  const TrajectoryProblem& problem_;
  Stages reference_, at_;
  bool exact_;
  int relaxed_ = 0;  // rows, the last ones
  double weight_ = 1;
  std::vector<int> turns_;  // first columns of orientations
  Eigen::VectorXd x_;
  LocalModel reference_model_, tangent_, linear_, curved_;
  Eigen::VectorXd row_values_;
  double cost_ = 0;
  bool cost_known_ = false, rows_known_ = false, linear_known_ = false;
};

}  // namespace lapwing
