// SPDX-License-Identifier: Apache-2.0
// The quasi-definite system of the interior point: ordered and assembled once, refactored with new
// diagonals. Internal to the room.
#pragma once

#include <array>
#include <vector>

#include "framework/solve/equilibration.h"
#include "framework/solve/supernodal_factors.h"

namespace lapwing {

class KktSystem {
 public:
  static constexpr double kRefined = 1e-9;  // relative residual that is good enough

  // Takes the values of a scaled problem. Analyses the sparsity unless it is the same as before.
  void set_up(const QuadraticProgram& problem, const std::vector<char>& fixed,
              const std::vector<RowKind>& rows);
  // `diagonal`: D_x (added to P) and D_s (inverted below). False when no regularisation helps.
  bool factorise(const Eigen::VectorXd& diagonal);
  // Of the last factors. As many as there are rows where the curvature is positive along all
  // directions that the rows leave free; more where it is not.
  int negative_pivots() const { return factors_.negative_pivots(); }
  // Relative residual of the solves since the last factors, the worst.
  double error() const { return error_; }
  // Solves without the regularisation, by refinement with a Krylov method to a relative residual.
  Eigen::VectorXd solve(const Eigen::VectorXd& right, double residual = kRefined);

 private:
  bool same_pattern(const QuadraticProgram& problem) const;
  void analyse(const QuadraticProgram& problem);
  void product(const Eigen::VectorXd& x, Eigen::VectorXd& result) const;

  int n_ = 0, m_ = 0;
  std::vector<int> hessian_outer_, hessian_inner_, jacobian_outer_, jacobian_inner_;
  std::vector<int> hessian_slots_, jacobian_slots_, diagonal_slots_;
  std::vector<int> place_;                 // of each number in the elimination order
  double of_rows_ = 0.0;                   // regularisation of the rows
  double error_ = 0.0, last_error_ = 0.0;  // relative residual after refinement: the worst since
                                           // the last factors, and when it last was not good enough
  std::vector<char> fixed_;
  std::vector<RowKind> rows_;
  Eigen::VectorXd base_diagonal_;   // P's
  Eigen::VectorXd regularisation_;  // added to the diagonal, signed, in order
  // Rows far from their bounds have numbers of the size of 1 / D_s; in the measure of the residual
  // they count by D_s, or they would hide the equations.
  Eigen::VectorXd weight_;
  Eigen::SparseMatrix<double> matrix_;  // upper triangle, in order
  SupernodalFactors factors_;
  static constexpr std::size_t kRefinements = 15;
  struct Scratch {
    Eigen::VectorXd right, x, residual, product;
    std::array<Eigen::VectorXd, kRefinements> directions, images;
  };
  Scratch scratch_;
};

}  // namespace lapwing
