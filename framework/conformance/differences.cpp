// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/differences.h"

#include <limits>

#include "framework/core/number_text.h"

namespace lapwing {
namespace {

constexpr double kStep = 1e-4;
constexpr double kOwnRounding = 1e-12;  // of a stated entry, in units of the largest in its row

// `floors`: at least this large an entry is taken to be, or null.
WorstEntry worst_entry(const RowMajorMatrix& stated, const Differences& found, double relative,
                       const RowMajorMatrix* floors) {
  WorstEntry worst;
  for (Eigen::Index r = 0; r < stated.rows(); ++r) {
    const double row = stated.row(r).cwiseAbs().maxCoeff();
    for (Eigen::Index c = 0; c < stated.cols(); ++c) {
      const double value = found.value(r, c);
      const double size =
          std::max({std::abs(stated(r, c)), std::abs(value), floors ? (*floors)(r, c) : 0.0});
      const double allowed = relative * size + found.error(r, c) + kOwnRounding * row;
      const double difference = std::abs(stated(r, c) - value);
      if (difference == 0) continue;
      const double excess = std::isfinite(difference) && std::isfinite(allowed)
                                ? difference / allowed
                                : std::numeric_limits<double>::infinity();
      if (excess <= worst.excess) continue;
      worst = {static_cast<int>(r), static_cast<int>(c), stated(r, c), value, excess};
    }
  }
  return worst;
}

}  // namespace

Differences central_differences(const VectorFunction& function, std::vector<double> x, int rows,
                                double size) {
  constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
  const Eigen::Index columns = static_cast<Eigen::Index>(x.size());
  Differences found{RowMajorMatrix(rows, columns), RowMajorMatrix(rows, columns)};
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(rows);  // of all that goes into a value
  std::vector<double> y(6 * rows), steps(x.size());
  for (Eigen::Index c = 0; c < columns; ++c) {
    const double at = x[c], h = size * kStep * std::max(1.0, std::abs(at));
    steps[c] = h;
    static constexpr double kPlaces[] = {-2, -1, -0.5, 0.5, 1, 2};
    for (int k = 0; k < 6; ++k) {
      x[c] = at + kPlaces[k] * h;
      function(x.data(), y.data() + k * rows);
    }
    x[c] = at;
    for (int r = 0; r < rows; ++r) {
      const auto value = [&](int k) { return y[k * rows + r]; };
      const double whole = (8 * (value(4) - value(1)) - (value(5) - value(0))) / (12 * h);
      const double half = (8 * (value(3) - value(2)) - (value(4) - value(1))) / (6 * h);
      found.value(r, c) = half;
      found.error(r, c) = std::abs(whole - half);
      for (int k = 0; k < 6; ++k) largest(r) = std::max(largest(r), std::abs(value(k)));
    }
  }
  // A value is rounded as the largest number that goes into it is, which may exceed the value.
  for (Eigen::Index c = 0; c < columns; ++c)
    largest += found.value.col(c).cwiseAbs() * std::abs(x[c]);
  for (Eigen::Index c = 0; c < columns; ++c) found.error.col(c) += kRounding / steps[c] * largest;
  return found;
}

WorstEntry compare_derivatives(const VectorFunction& function, const std::vector<double>& x,
                               const RowMajorMatrix& stated, double relative) {
  const int rows = static_cast<int>(stated.rows());
  const WorstEntry first =
      worst_entry(stated, central_differences(function, x, rows), relative, nullptr);
  if (first.excess <= 1) return first;
  const WorstEntry second =
      worst_entry(stated, central_differences(function, x, rows, 0.05), 10 * relative, nullptr);
  return second.excess <= 1 ? second : first;
}

bool agrees_along(const VectorFunction& function, const std::vector<double>& x,
                  const std::vector<double>& direction, const RowMajorMatrix& stated,
                  double relative) {
  const int rows = static_cast<int>(stated.rows());
  std::vector<double> moved(x.size()), way(x.size());
  for (std::size_t c = 0; c < x.size(); ++c) way[c] = direction[c] * std::max(1.0, std::abs(x[c]));
  const Differences found = central_differences(
      [&](const double* at, double* y) {
        for (std::size_t c = 0; c < x.size(); ++c) moved[c] = x[c] + *at * way[c];
        function(moved.data(), y);
      },
      {0.0}, rows);
  const Eigen::Map<const Eigen::VectorXd> step(way.data(), static_cast<Eigen::Index>(way.size()));
  const RowMajorMatrix along = stated * step;
  const RowMajorMatrix size = stated.cwiseAbs() * step.cwiseAbs();
  return worst_entry(along, found, relative, &size).excess <= 1;
}

std::string text_of(double number) {
  return plain_number(number, 7);
}

}  // namespace lapwing
