// SPDX-License-Identifier: Apache-2.0
// A smooth curve through noisy samples: a cubic spline with even knots and a penalty of its third
// derivative, whose weight generalized cross-validation chooses (Craven and
// Wahba, 1979).
#pragma once

#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct CurveSamples {
  std::vector<double> times;  // s, rising
  Eigen::MatrixXd values;     // a row for each time, a column for each coordinate
  // The derivatives at times of their own, rising, likewise; none: they are not known.
  std::vector<double> rate_times = {};
  Eigen::MatrixXd rates = {};
};

class SmoothCurve {
 public:
  // From `start` to `finish` s with knots about `step` s apart, 20000 at most; samples outside are
  // left out. Throws Error for fewer than four samples inside.
  SmoothCurve(const CurveSamples& samples, double start, double finish, double step);

  double start() const { return start_; }
  double step() const { return step_; }
  std::size_t intervals() const { return count_; }
  double time(std::size_t knot) const { return start_ + step_ * static_cast<double>(knot); }

  // Derivative `order` (0 to 3) at a time; the third is constant between knots, and the one behind
  // a knot there. Outside of the knots the nearest interval goes on.
  Eigen::VectorXd at(double time, int order = 0) const;

  // Root of the mean square of what separates the samples from the curve, over all coordinates.
  double residual() const { return residual_; }

 private:
  double start_ = 0, step_ = 1;
  std::size_t count_ = 0;
  Eigen::MatrixXd coefficients_;  // count + 3 rows
  double residual_ = 0;
};

}  // namespace lapwing
