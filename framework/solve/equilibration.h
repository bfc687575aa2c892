// SPDX-License-Identifier: Apache-2.0
// Ruiz equilibration of a quadratic program (CERFACS TR/PA/01/35, 2001): x = D x^, rows by E, cost
// by sigma, so that the columns of [P A'; A 0] have about unit norm. Internal to the room.
#pragma once

#include <vector>

#include "framework/solve/quadratic_program.h"

namespace lapwing {

enum class RowKind { equation, inequality, unbounded };

class Equilibration {
 public:
  void compute(const QuadraticProgram& problem, const std::vector<char>& fixed,
               const std::vector<RowKind>& rows);
  void apply(const QuadraticProgram& problem, QuadraticProgram& scaled) const;

  Eigen::VectorXd scaled_x(const Eigen::VectorXd& x) const { return x.cwiseQuotient(columns_); }
  Eigen::VectorXd unscaled_x(const Eigen::VectorXd& x) const { return x.cwiseProduct(columns_); }
  double cost_factor() const { return cost_; }
  const Eigen::VectorXd& row_factors() const { return rows_; }
  Eigen::VectorXd scaled_row_multipliers(const Eigen::VectorXd& y) const {
    return cost_ * y.cwiseQuotient(rows_);
  }
  Eigen::VectorXd unscaled_row_multipliers(const Eigen::VectorXd& y) const {
    return y.cwiseProduct(rows_) / cost_;
  }
  Eigen::VectorXd scaled_bound_multipliers(const Eigen::VectorXd& z) const {
    return cost_ * z.cwiseProduct(columns_);
  }
  Eigen::VectorXd unscaled_bound_multipliers(const Eigen::VectorXd& z) const {
    return z.cwiseQuotient(columns_) / cost_;
  }

 private:
  Eigen::VectorXd columns_, rows_;
  double cost_ = 1.0;
};

}  // namespace lapwing
