// SPDX-License-Identifier: Apache-2.0
// The linear equations of a Poisson reconstruction, in the shape in which CGAL fills them in: a
// symmetric, positive definite matrix. Internal to this room; without Eigen, whose headers would
// double what poisson_field.cpp takes to compile.
#pragma once

#include <cstddef>
#include <vector>

namespace lapwing {

class PoissonVector {
 public:
  explicit PoissonVector(std::size_t size) : values_(size, 0) {}
  double& operator[](std::size_t i) { return values_[i]; }
  double operator[](std::size_t i) const { return values_[i]; }
  std::size_t size() const { return values_.size(); }

 private:
  std::vector<double> values_;
};

class PoissonMatrix {
 public:
  explicit PoissonMatrix(std::size_t rows) : rows_(rows) {}
  // Each entry once, both halves of the matrix.
  void set_coef(std::size_t row, std::size_t column, double value, bool /*is_new*/) {
    entries_.push_back({row, column, value});
  }

  struct Entry {
    std::size_t row, column;
    double value;
  };
  std::size_t rows() const { return rows_; }
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::size_t rows_;
  std::vector<Entry> entries_;
};

// By conjugate gradients, preconditioned by the diagonal, down to 1e-9 of the right side.
struct PoissonSolver {
  using Matrix = PoissonMatrix;
  using Vector = PoissonVector;
  using NT = double;
  // Whether x was found; `scale` becomes 1, as CGAL wants to hear.
  bool linear_solver(const Matrix& a, const Vector& b, Vector& x, double& scale) const;
};

}  // namespace lapwing
