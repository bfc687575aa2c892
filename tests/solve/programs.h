// SPDX-License-Identifier: Apache-2.0
// Small quadratic programs, written densely.
#pragma once

#include <initializer_list>
#include <limits>

#include <Eigen/Dense>

#include "framework/core/random.h"
#include "framework/solve/quadratic_program.h"

namespace lapwing {

inline constexpr double kOpen = std::numeric_limits<double>::infinity();

// `p`: whole or lower triangle.
inline QuadraticProgram dense_program(const Eigen::MatrixXd& p, const Eigen::VectorXd& c,
                                      const Eigen::MatrixXd& a, const Eigen::VectorXd& row_lower,
                                      const Eigen::VectorXd& row_upper,
                                      const Eigen::VectorXd& x_lower,
                                      const Eigen::VectorXd& x_upper) {
  const Eigen::MatrixXd lower = p.triangularView<Eigen::Lower>();
  return {lower.sparseView(), c, a.sparseView(), row_lower, row_upper, x_lower, x_upper};
}

inline Eigen::VectorXd numbers(std::initializer_list<double> list) {
  return Eigen::Map<const Eigen::VectorXd>(list.begin(), static_cast<Eigen::Index>(list.size()));
}

inline Eigen::VectorXd normal_vector(int n, Random& random) {
  Eigen::VectorXd v(n);
  for (double& x : v) x = random.normal();
  return v;
}

inline Eigen::MatrixXd normal_matrix(int rows, int columns, Random& random) {
  Eigen::MatrixXd matrix(rows, columns);
  for (double& x : matrix.reshaped()) x = random.normal();
  return matrix;
}

// Without rows.
inline QuadraticProgram box_program(const Eigen::MatrixXd& p, const Eigen::VectorXd& c,
                                    const Eigen::VectorXd& x_lower,
                                    const Eigen::VectorXd& x_upper) {
  return dense_program(p, c, Eigen::MatrixXd::Zero(0, c.size()), Eigen::VectorXd(0),
                       Eigen::VectorXd(0), x_lower, x_upper);
}

}  // namespace lapwing
