// SPDX-License-Identifier: Apache-2.0
// The augmented Lagrangian of Powell, Hestenes and Rockafellar over everything that the flight does
// not meet by itself: rows that are not dynamics, and bounds.
//
//   L(x) = cost(x) + sum_i rho_i/2 e_i^2,   e_i = distance of c_i - y_i/rho_i from [lower, upper]
//
// Smooth once; its minimiser's -rho_i e_i are the next multipliers y_i. They are signed as the
// kernel's: above zero where the lower limit holds.
#pragma once

#include "framework/problem/trajectory_problem.h"

namespace lapwing {

// One limited quantity: a column of the problem or one of its rows.
struct Limited {
  bool is_row = false;
  int index = 0;
  double multiplier = 0, penalty = 1;
  double error = 0;      // e at the last evaluation
  double violation = 0;  // there
  double miss = 0;       // |change of the multiplier| / penalty at the last update
};

// A row of the problem that weighs something, with its gradient.
struct ActiveRow {
  double penalty;
  std::vector<std::pair<int, double>> entries;  // column, value; in order
};

class AugmentedCost {
 public:
  // Rows that are not dynamics and have a limit, and `columns` that have one.
  AugmentedCost(const TrajectoryProblem& problem, const std::vector<int>& columns);

  std::vector<Limited>& limited() { return limited_; }
  const std::vector<Limited>& limited() const { return limited_; }

  // L at the model's point; `gradient` in all columns.
  double evaluate(const LocalModel& model, Eigen::VectorXd& gradient);
  // Gauss-Newton Hessian of L, the limits with an error held, times a step of all columns. Prepared
  // once for many steps.
  void prepare_hessian(const LocalModel& model);
  const std::vector<ActiveRow>& active_rows() const { return active_; }
  void hessian_times(const LocalModel& model, const Eigen::VectorXd& step,
                     Eigen::VectorXd& product) const;
  // Takes the next multipliers. Returns the largest miss.
  double update();
  // At the last evaluation: the largest violation, and the sum of penalty/2 violation^2.
  double worst_violation() const;
  double violation_energy() const;
  // Raises the penalties of what was missed by more than `tolerance` and did not come down enough.
  void raise(double tolerance);

 private:
  int dynamics_rows_ = 0;
  std::vector<Limited> limited_;
  std::vector<ActiveRow> active_;
  std::vector<double> before_;  // misses of the update before
  Eigen::VectorXd weights_;     // per row
};

}  // namespace lapwing
