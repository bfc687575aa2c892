// SPDX-License-Identifier: Apache-2.0
// Derivatives compared with central differences. Internal to the room.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using VectorFunction = std::function<void(const double* x, double* y)>;

// dy/dx by fourth-order central differences with two steps, and how far each entry can be trusted:
// what the two steps differ by, and what rounding of values as large as these can do.
struct Differences {
  RowMajorMatrix value, error;
};
// `size` times the usual step, which is 1e-4 of each number, at least of 1.
Differences central_differences(const VectorFunction& function, std::vector<double> x, int rows,
                                double size = 1.0);

struct WorstEntry {
  int row = 0, column = 0;
  double stated = 0, expected = 0;
  double excess = 0;  // how often the tolerance; at most 1 is agreement
};

// Worst disagreement between a stated Jacobian and differences. An entry is wrong where it differs
// by more than `relative` of itself and the error of the differences, so that a small entry is
// judged beside large ones and a small function as a large one. Where the first step disagrees a
// smaller one is tried, lest a kink nearby be taken for an error.
WorstEntry compare_derivatives(const VectorFunction& function, const std::vector<double>& x,
                               const RowMajorMatrix& stated, double relative);

// Whether the function changes as `stated` says along `direction`, in units of 1e-4 of each number:
// six evaluations in place of six per column. A rough sieve: what falls through is compared whole.
bool agrees_along(const VectorFunction& function, const std::vector<double>& x,
                  const std::vector<double>& direction, const RowMajorMatrix& stated,
                  double relative);

// "-1.25e-08": numbers of any size are told apart.
std::string text_of(double number);

}  // namespace lapwing
