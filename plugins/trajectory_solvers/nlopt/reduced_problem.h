// SPDX-License-Identifier: Apache-2.0
// The trajectory problem in the numbers that are left when it is flown: those that are neither
// fixed nor follow from earlier ones.
//
// Every dynamics row fixes its last column (the next stage's state, the last input, the clock) from
// earlier ones, so the rows' Jacobian is triangular in these *dependent* columns: derivatives of
// the flown trajectory need one sweep through it, forward for a direction, backward for a gradient
// (the adjoint), and no factorisation.
#pragma once

#include "framework/problem/trajectory_problem.h"

namespace lapwing {

class ReducedProblem {
 public:
  // Why a problem cannot be reduced, "" when it can.
  static std::string unsupported(const TrajectoryProblem& problem);

  // Keeps `problem` by reference.
  explicit ReducedProblem(const TrajectoryProblem& problem);

  const TrajectoryProblem& problem() const { return problem_; }
  // Columns of the numbers that are left, in order.
  const std::vector<int>& columns() const { return independent_; }
  int size() const { return static_cast<int>(independent_.size()); }
  bool dependent(int column) const { return pivot_row_[column] >= 0; }
  // The dynamics row that fixes a dependent column.
  struct Entry {
    int column;
    int slot;  // in the Jacobian's values
  };
  struct Row {
    int row, pivot, pivot_slot;
    std::vector<Entry> others;
  };
  const Row& row_of(int column) const { return sweep_[pivot_row_[column]]; }

  // The trajectory flown after its independent numbers are moved by `step` (size()).
  Stages fly(const Stages& from, const Eigen::VectorXd& step) const;

  // Step of all columns that follows a step of the independent ones, to first order. With `rows`,
  // one that also makes these row values vanish.
  void forward(const LocalModel& model, const Eigen::VectorXd& step, const Eigen::VectorXd* rows,
               Eigen::VectorXd& all) const;

  // The adjoint: from the gradient in all columns, as if they were free, to the gradient in the
  // independent ones. `gradient` ends as what is left of it, zero in dependent columns.
  // `multipliers` (one per dynamics row), if given, get those of the Lagrangian cost + l'c.
  void backward(const LocalModel& model, Eigen::VectorXd& gradient, Eigen::VectorXd& reduced,
                Eigen::VectorXd* multipliers) const;

 private:
  const TrajectoryProblem& problem_;
  std::vector<Row> sweep_;      // dynamics rows by pivot column
  std::vector<int> pivot_row_;  // by column: where in sweep_ the row is that fixes it, or -1
  std::vector<int> independent_;
};

}  // namespace lapwing
