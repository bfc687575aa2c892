// A change of variables that makes the reduced problem round: v = S w with S S' the inverse of its
// Gauss-Newton Hessian (or of that matrix's diagonal), so that a gradient step in w is a Newton
// step in v.
#pragma once

#include <functional>

#include <Eigen/Core>

namespace lapwing {

class Scaling {
 public:
  // `column(k, result)` writes column k of the Hessian, n numbers. Its small and negative pivots
  // are made safe. `dense`: the whole matrix is factored, n^3 / 6 products.
  void set(int n, bool dense, const std::function<void(int, Eigen::VectorXd& result)>& column);

  Eigen::VectorXd to_variables(const Eigen::VectorXd& w) const;  // S w
  Eigen::VectorXd to_gradient(const Eigen::VectorXd& g) const;   // S' g
  bool dense() const { return dense_; }
  // Diagonal scaling only: w of each variable's unit.
  const Eigen::VectorXd& roots() const { return roots_; }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  bool factor(double regularisation);

  bool dense_ = false;
  RowMajor matrix_, factor_;  // Hessian, and its lower Cholesky factor
  Eigen::VectorXd roots_;
};

}  // namespace lapwing
