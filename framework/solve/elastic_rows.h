// SPDX-License-Identifier: Apache-2.0
// Rows of an interior point that may be missed, at a price.
//
// Row r is met as values + p - q, with p, q > 0 and a penalty on p + q; z_p and z_q are the
// multipliers of p and q. None of them is a variable of the linear system: they are eliminated from
// it and change one number of its diagonal and one of its right side per row. In scaled numbers.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "framework/solve/equilibration.h"

namespace lapwing {

class ElasticRows {
 public:
  // Steps of p and q.
  struct Steps {
    Eigen::VectorXd p, q;
  };

  bool active() const { return active_; }
  // Of a unit of violation; 0 before the first `begin`.
  double penalty() const { return penalty_; }

  // Makes all rows elastic that have a bound. `away`: what is missing in each row, which p and q
  // then make up for, at the barrier's minimum.
  void begin(const std::vector<RowKind>& rows, const Eigen::VectorXd& away, double penalty,
             double barrier);
  // No row is elastic any more; the penalty is remembered.
  void end() { active_ = false; }

  // p - q, and its change by the whole step.
  double miss(int r) const { return p_(r) - q_(r); }
  double change_of_miss(int r) const { return steps_.p(r) - steps_.q(r); }
  // What the diagonal of the row gets beside its slack's part.
  double relief(int r) const { return p_(r) / z_p_(r) + q_(r) / z_q_(r); }
  // The largest deviation of a product of p or q and its multiplier from the barrier parameter.
  double deviation(double barrier) const;

  // What the right side of a row gets, whose multiplier is `y`. Remembered for `follow`.
  double aim(int r, double y, double barrier);
  // All steps, from those of the rows' multipliers.
  void follow(const Eigen::VectorXd& y, const Eigen::VectorXd& dy);
  const Steps& steps() const { return steps_; }
  void set_steps(Steps steps) { steps_ = std::move(steps); }

  // Shortens `alpha` so that each number keeps `1 - share` of itself at least.
  void limit(bool of_multipliers, double share, double& alpha) const;
  // Adds the logarithms of p and q, and their sum, after a share `alpha` of the step.
  void add_cost(double alpha, double& logarithms, double& sum) const;
  // Adds the slope of penalty and barrier along the step.
  void add_slope(double barrier, double& slope) const;
  void take(double alpha, double of_multipliers);
  // Calls `keep(multiplier, number)` for each pair.
  template <class Keep>
  void keep(const Keep& keep) {
    for (Eigen::Index r = 0; r < p_.size(); ++r) {
      keep(z_p_(r), p_(r));
      keep(z_q_(r), q_(r));
    }
  }

 private:
  bool active_ = false;
  double penalty_ = 0;
  std::vector<int> rows_;
  Eigen::VectorXd p_, q_, z_p_, z_q_;
  Eigen::VectorXd aim_p_, aim_q_;
  Steps steps_;
  Eigen::VectorXd dz_p_, dz_q_;
};

}  // namespace lapwing
