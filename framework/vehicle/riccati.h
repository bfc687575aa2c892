// SPDX-License-Identifier: Apache-2.0
// Linear quadratic regulators.
#pragma once

#include <Eigen/Core>

namespace lapwing {

// K of the feedback u = -K x that minimises the integral of x'Qx + u'Ru for x' = A x + B u, from
// the stabilising solution of the algebraic Riccati equation A'P + PA - P B R^-1 B' P + Q = 0
// by the matrix sign function of the Hamiltonian (Roberts, Int. J. Control 32(4), 1980; Byers,
// Linear Algebra Appl. 85, 1987). Throws Error when there is none: (A, B) is not stabilisable, or
// Q leaves a mode on the imaginary axis unseen.
Eigen::MatrixXd regulator_gain(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                               const Eigen::MatrixXd& q, const Eigen::MatrixXd& r);

}  // namespace lapwing
