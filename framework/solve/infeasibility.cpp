// SPDX-License-Identifier: Apache-2.0
#include "framework/solve/infeasibility.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

using Eigen::VectorXd;

constexpr double kCertificate = 1e-8;  // relative size of a proof's residual
constexpr double kRounding = 1e-10;    // relative size of a sum that is not rounding

}  // namespace

bool is_infeasibility_certificate(const QuadraticProgram& problem, const QuadraticResult& at) {
  VectorXd y = at.row_multipliers;
  const auto bound = [](double multiplier, double low, double high) {
    return multiplier > 0 ? low : high;
  };
  for (int r = 0; r < problem.rows(); ++r)
    if (!std::isfinite(bound(y(r), problem.row_lower(r), problem.row_upper(r)))) y(r) = 0.0;
  const VectorXd aty = problem.jacobian.transpose() * y;
  double value = 0, size = 0, residual = 0;
  const auto add = [&](double multiplier, double limit) {
    value += multiplier * limit;
    size += std::abs(multiplier * limit);
  };
  for (int r = 0; r < problem.rows(); ++r)
    if (y(r) != 0.0) add(y(r), bound(y(r), problem.row_lower(r), problem.row_upper(r)));
  // A bound on the side that A'y pushes to takes it up exactly; else it is the proof's residual.
  for (int i = 0; i < problem.variables(); ++i) {
    const double limit = bound(-aty(i), problem.x_lower(i), problem.x_upper(i));
    if (std::isfinite(limit))
      add(-aty(i), limit);
    else
      residual = std::max(residual, std::abs(aty(i)));
  }
  return value > kRounding * size && residual * (1.0 + largest_size(at.x)) < kCertificate * value;
}

bool is_unbounded_ray(const QuadraticProgram& problem, const Eigen::VectorXd& x) {
  const double fall = -problem.gradient.dot(x);
  if (!(fall > 0)) return false;
  const VectorXd px = problem.hessian.selfadjointView<Eigen::Lower>() * x;
  const VectorXd ax = problem.jacobian * x;
  // Curvature counts against what each row of P could make of a point of this size: a long point
  // along a slight curvature is no ray.
  const VectorXd reach = problem.hessian.cwiseAbs().selfadjointView<Eigen::Lower>() *
                         VectorXd::Constant(x.size(), largest_size(x));
  if ((px.cwiseAbs().array() > kCertificate * reach.array()).any()) return false;
  double residual = largest_size(px);
  const auto add = [&](double v, double low, double high) {
    if (std::isfinite(low)) residual = std::max(residual, -v);
    if (std::isfinite(high)) residual = std::max(residual, v);
  };
  for (int i = 0; i < problem.variables(); ++i) add(x(i), problem.x_lower(i), problem.x_upper(i));
  for (int r = 0; r < problem.rows(); ++r) add(ax(r), problem.row_lower(r), problem.row_upper(r));
  return residual * (1.0 + largest_size(problem.gradient)) < kCertificate * fall;
}

}  // namespace lapwing
