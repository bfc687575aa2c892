#include "framework/conformance/differences.h"

namespace lapwing {
namespace {

WorstEntry worst_entry(const RowMajorMatrix& stated, const RowMajorMatrix& expected,
                       double relative) {
  WorstEntry worst;
  for (Eigen::Index r = 0; r < stated.rows(); ++r) {
    const double scale =
        std::max({1.0, stated.row(r).cwiseAbs().maxCoeff(), expected.row(r).cwiseAbs().maxCoeff()});
    for (Eigen::Index c = 0; c < stated.cols(); ++c) {
      const double excess = std::abs(stated(r, c) - expected(r, c)) / (relative * scale);
      if (excess <= worst.excess) continue;
      worst = {static_cast<int>(r), static_cast<int>(c), stated(r, c), expected(r, c), excess};
    }
  }
  return worst;
}

}  // namespace

RowMajorMatrix central_differences(const VectorFunction& function, std::vector<double> x, int rows,
                                   double size) {
  RowMajorMatrix result(rows, x.size());
  std::vector<double> y(4 * rows);
  for (std::size_t c = 0; c < x.size(); ++c) {
    const double at = x[c], h = size * 1e-4 * std::max(1.0, std::abs(at));
    static constexpr double kPlaces[] = {-2, -1, 1, 2};
    for (int k = 0; k < 4; ++k) {
      x[c] = at + kPlaces[k] * h;
      function(x.data(), y.data() + k * rows);
    }
    x[c] = at;
    for (int r = 0; r < rows; ++r)
      result(r, static_cast<Eigen::Index>(c)) =
          (8 * (y[2 * rows + r] - y[rows + r]) - (y[3 * rows + r] - y[r])) / (12 * h);
  }
  return result;
}

WorstEntry compare_derivatives(const VectorFunction& function, const std::vector<double>& x,
                               const RowMajorMatrix& stated, double relative) {
  const int rows = static_cast<int>(stated.rows());
  const WorstEntry first = worst_entry(stated, central_differences(function, x, rows), relative);
  if (first.excess <= 1) return first;
  const WorstEntry second =
      worst_entry(stated, central_differences(function, x, rows, 0.05), 10 * relative);
  return second.excess <= 1 ? second : first;
}

}  // namespace lapwing
