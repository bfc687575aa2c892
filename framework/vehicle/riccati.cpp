// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/riccati.h"

#include <Eigen/LU>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {

using Eigen::MatrixXd;

namespace {

constexpr int kSteps = 100;         // scaled Newton steps converge quadratically: about ten suffice
constexpr double kSettled = 1e-13;  // relative change of the sign that ends the iteration
constexpr double kResidual = 1e-6;  // of the equation, against its own terms

[[noreturn]] void no_solution() {
  throw Error("the Riccati equation has no stabilising solution");
}

// The matrix sign of z by Newton's iteration, scaled by the determinant (Byers 1987, section 2).
// Eigenvalues on the imaginary axis have no sign: the iteration then never settles.
MatrixXd sign_of(MatrixXd z) {
  const double n = static_cast<double>(z.rows());
  for (int k = 0; k < kSteps; ++k) {
    const Eigen::PartialPivLU<MatrixXd> lu(z);
    const double determinant = std::abs(lu.determinant());
    if (!(determinant > 0) || !std::isfinite(determinant)) no_solution();
    const double scale = std::pow(determinant, -1 / n);
    const MatrixXd next = 0.5 * (scale * z + lu.inverse() / scale);
    const double change = (next - z).norm();
    z = next;
    if (change <= kSettled * z.norm()) return z;
  }
  no_solution();
}

}  // namespace

MatrixXd regulator_gain(const MatrixXd& a, const MatrixXd& b, const MatrixXd& q,
                        const MatrixXd& r) {
  const Eigen::Index n = a.rows();
  const MatrixXd feedback = r.inverse().lazyProduct(b.transpose());
  MatrixXd hamiltonian(2 * n, 2 * n);
  hamiltonian << a, -b.lazyProduct(feedback), -q, -a.transpose();
  const MatrixXd sign = sign_of(hamiltonian);
  // The stable subspace, spanned by [I; P], is the kernel of sign + I: 2n equations for P's n
  // rows, of which any consistent combination of full rank will do.
  MatrixXd left(2 * n, n), right(2 * n, n);
  left << sign.topRightCorner(n, n), sign.bottomRightCorner(n, n) + MatrixXd::Identity(n, n);
  right << sign.topLeftCorner(n, n) + MatrixXd::Identity(n, n), sign.bottomLeftCorner(n, n);
  const MatrixXd normal = left.transpose().lazyProduct(left);
  const MatrixXd p = -normal.inverse().lazyProduct(left.transpose().lazyProduct(right));
  const MatrixXd pa = p.lazyProduct(a);
  const MatrixXd curved = p.lazyProduct(b).lazyProduct(feedback).lazyProduct(p);
  const double residual = (pa + pa.transpose() - curved + q).norm();
  if (!(residual <= kResidual * (2 * pa.norm() + curved.norm() + q.norm()))) no_solution();
  return feedback.lazyProduct(p);
}

}  // namespace lapwing
