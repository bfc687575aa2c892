// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/sparse_pattern.h"

#include <algorithm>

#include "framework/core/error.h"

namespace lapwing {

Eigen::SparseMatrix<double> SparsePattern::finish() {
  std::sort(keys_.begin(), keys_.end());
  keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
  Eigen::SparseMatrix<double> matrix(rows_, columns_);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(keys_.size()));
  int* const outer = matrix.outerIndexPtr();
  std::fill_n(outer, columns_ + 1, 0);
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    matrix.innerIndexPtr()[k] = static_cast<int>(keys_[k] & 0xffffffffu);
    matrix.valuePtr()[k] = 0.0;
    ++outer[(keys_[k] >> 32) + 1];
  }
  for (int column = 0; column < columns_; ++column) outer[column + 1] += outer[column];
  return matrix;
}

int SparsePattern::slot(int row, int column) const {
  const std::uint64_t key =
      (static_cast<std::uint64_t>(column) << 32) | static_cast<std::uint32_t>(row);
  const auto found = std::lower_bound(keys_.begin(), keys_.end(), key);
  if (found == keys_.end() || *found != key) throw Error("entry outside the sparse pattern");
  return static_cast<int>(found - keys_.begin());
}

}  // namespace lapwing
