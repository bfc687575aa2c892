// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/sparse_pattern.h"

#include <set>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

TEST(SparsePattern, HoldsWhatWasAddedOnce) {
  Random random(1);
  std::set<std::pair<int, int>> entries;
  SparsePattern pattern(17, 11);
  for (int k = 0; k < 200; ++k) {
    const int row = static_cast<int>(random.integer(0, 16));
    const int column = static_cast<int>(random.integer(0, 9));  // the last column stays empty
    pattern.add(row, column);
    entries.insert({row, column});
  }
  Eigen::SparseMatrix<double> matrix = pattern.finish();
  ASSERT_EQ(matrix.rows(), 17);
  ASSERT_EQ(matrix.cols(), 11);
  ASSERT_EQ(matrix.nonZeros(), static_cast<Eigen::Index>(entries.size()));
  ASSERT_TRUE(matrix.isCompressed());
  for (const auto& [row, column] : entries)
    matrix.valuePtr()[pattern.slot(row, column)] = 100.0 * row + column + 1.0;
  for (int row = 0; row < 17; ++row)
    for (int column = 0; column < 11; ++column)
      EXPECT_EQ(matrix.coeff(row, column),
                entries.contains({row, column}) ? 100.0 * row + column + 1.0 : 0.0);
}

TEST(SparsePattern, KnowsWhatWasNotAdded) {
  SparsePattern pattern(3, 3);
  pattern.add(1, 2);
  pattern.finish();
  EXPECT_EQ(pattern.slot(1, 2), 0);
  EXPECT_THROW(pattern.slot(2, 1), Error);
  EXPECT_THROW(pattern.slot(0, 0), Error);
}

TEST(SparsePattern, MayBeEmpty) {
  SparsePattern pattern(4, 2);
  const Eigen::SparseMatrix<double> matrix = pattern.finish();
  EXPECT_EQ(matrix.nonZeros(), 0);
  EXPECT_EQ(matrix.rows(), 4);
  EXPECT_EQ(matrix.cols(), 2);
}

}  // namespace
}  // namespace lapwing
