#include "framework/vehicle/riccati.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "framework/core/error.h"

namespace lapwing {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

MatrixXd regulator_gain(const MatrixXd& a, const MatrixXd& b, const MatrixXd& q,
                        const MatrixXd& r) {
  const Eigen::Index n = a.rows();
  const MatrixXd feedback = r.inverse().lazyProduct(b.transpose());
  MatrixXd hamiltonian(2 * n, 2 * n);
  hamiltonian << a, -b.lazyProduct(feedback), -q, -a.transpose();
  const Eigen::EigenSolver<MatrixXd> eigen(hamiltonian);
  MatrixXcd stable(2 * n, n);
  Eigen::Index found = 0;
  for (Eigen::Index i = 0; i < 2 * n; ++i)
    if (eigen.eigenvalues()(i).real() < 0) {
      if (found < n) stable.col(found) = eigen.eigenvectors().col(i);
      ++found;
    }
  if (found != n) throw Error("the Riccati equation has no stabilising solution");
  const MatrixXcd upper = stable.topRows(n), lower = stable.bottomRows(n);
  const MatrixXd p = (lower.lazyProduct(upper.inverse())).real();
  if (!p.allFinite()) throw Error("the Riccati equation has no stabilising solution");
  return feedback.lazyProduct(p);
}

}  // namespace lapwing
