// SPDX-License-Identifier: Apache-2.0
// A change of variables that makes the reduced problem round: v = S w with S' H S = I, where H is
// its Gauss-Newton Hessian, so that a gradient step in w is a Newton step in v.
//
// H itself is dense, but it comes from a banded matrix over all columns of the problem and from
// dynamics that reach one stage back. So columns are eliminated from the last to the first within
// the band, as dynamic programming does: a dependent one by its row, x_c = sum b_k x_k; an
// independent one by completing the square,
//
//   h x_c^2 + 2 x_c sum h_j x_j  ->  w_c = sqrt(h) (x_c + sum f_j x_j),   f_j = h_j / h.
//
// w is how far an input is from the best answer to what came before. All costs grow with the
// number of stages.
#pragma once

#include "plugins/trajectory_solvers/nlopt/augmented_cost.h"
#include "plugins/trajectory_solvers/nlopt/reduced_problem.h"

namespace lapwing {

class Scaling {
 public:
  explicit Scaling(const ReducedProblem& reduced) : reduced_(reduced) {}

  // S as above, of the augmented cost as it was last prepared (prepare_hessian).
  void set_whole(const LocalModel& model, const AugmentedCost& cost);
  // S diagonal: v_k = w_k / roots_k from the diagonal of H.
  void set_diagonal(const LocalModel& model, const AugmentedCost& cost);

  Eigen::VectorXd to_variables(const Eigen::VectorXd& w) const;  // S w
  Eigen::VectorXd to_gradient(const Eigen::VectorXd& g) const;   // S' g
  const Eigen::VectorXd& roots() const { return roots_; }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void fill(const LocalModel& model, const AugmentedCost& cost);
  void substitute(int column, const LocalModel& model);
  void complete_square(int column, int variable);
  // Entry (column, other), column >= other > column - band.
  double& at(int column, int other) { return band_(column, other - column + width_ - 1); }
  double at(int column, int other) const { return band_(column, other - column + width_ - 1); }

  const ReducedProblem& reduced_;
  bool whole_ = false;
  int width_ = 0;          // of the band, diagonal included
  RowMajor band_;          // rows c: entries (c, c - width + 1 ... c); then f and b of each column
  Eigen::VectorXd gross_;  // what was ever added to each diagonal entry
  double smallest_ = 0;
  Eigen::VectorXd roots_;
};

}  // namespace lapwing
