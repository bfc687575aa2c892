// SPDX-License-Identifier: Apache-2.0
// A sparse matrix whose non-zeros are known once and whose values are written many times.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/SparseCore>

namespace lapwing {

class SparsePattern {
 public:
  SparsePattern(int rows, int columns) : rows_(rows), columns_(columns) {}

  void add(int row, int column) {
    keys_.push_back((static_cast<std::uint64_t>(column) << 32) | static_cast<std::uint32_t>(row));
  }
  // After the last `add`: a compressed matrix of zeros.
  Eigen::SparseMatrix<double> finish();
  // Index into valuePtr() of an entry that was added.
  int slot(int row, int column) const;

 private:
  int rows_, columns_;
  std::vector<std::uint64_t> keys_;  // sorted and unique after finish
};

}  // namespace lapwing
