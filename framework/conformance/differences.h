// Derivatives compared with central differences. Internal to the room.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using VectorFunction = std::function<void(const double* x, double* y)>;

// dy/dx by fourth-order central differences, `size` times the usual step.
RowMajorMatrix central_differences(const VectorFunction& function, std::vector<double> x, int rows,
                                   double size = 1.0);

struct WorstEntry {
  int row = 0, column = 0;
  double stated = 0, expected = 0;
  double excess = 0;  // how often the tolerance; at most 1 is agreement
};

// Worst disagreement between a stated Jacobian and differences. The tolerance of an entry is
// `relative` of the largest number in its row, at least of 1. Where the first step disagrees a
// smaller one is tried, lest a kink nearby be taken for an error.
WorstEntry compare_derivatives(const VectorFunction& function, const std::vector<double>& x,
                               const RowMajorMatrix& stated, double relative);

}  // namespace lapwing
