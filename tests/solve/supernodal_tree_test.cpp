// SPDX-License-Identifier: Apache-2.0
// Elimination trees and supernodes against elimination written out on sets.
#include "framework/solve/supernodal_tree.h"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/solve/supernodal_factors.h"

namespace lapwing {
namespace {

using Pattern = Eigen::SparseMatrix<double>;

Pattern pattern_of(int n, const std::vector<std::pair<int, int>>& places) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 4.0 * n);
  for (const auto& [i, j] : places) entries.emplace_back(std::min(i, j), std::max(i, j), 1.0);
  Pattern upper(n, n);
  upper.setFromTriplets(entries.begin(), entries.end());
  return upper;
}

// Column by column: what a column touches below it is then joined pairwise.
std::vector<std::set<int>> eliminated(const Pattern& upper) {
  const int n = static_cast<int>(upper.cols());
  std::vector<std::set<int>> below(n);
  for (int j = 0; j < n; ++j)
    for (Pattern::InnerIterator e(upper, j); e; ++e)
      if (e.row() < j) below[e.row()].insert(j);
  for (int j = 0; j < n; ++j)
    for (int a : below[j])
      for (int b : below[j])
        if (b > a) below[a].insert(b);
  return below;
}

Pattern random_pattern(int n, double share, Random& random) {
  std::vector<std::pair<int, int>> places;
  for (int k = 0; k < share * n; ++k) {
    const int i = static_cast<int>(random.integer(0, n - 1));
    const int j = static_cast<int>(random.integer(0, n - 1));
    if (i != j) places.emplace_back(i, j);
  }
  return pattern_of(n, places);
}

TEST(SupernodalTree, EqualsEliminationOnSets) {
  Random random(1);
  for (int k = 0; k < 60; ++k) {
    const int n = static_cast<int>(random.integer(1, 40));
    const Pattern upper = random_pattern(n, random.uniform(0, 4), random);
    const std::vector<std::set<int>> below = eliminated(upper);
    const EliminationTree tree = elimination_tree(upper);
    for (int j = 0; j < n; ++j) {
      EXPECT_EQ(tree.below[j], static_cast<int>(below[j].size())) << k << ", column " << j;
      EXPECT_EQ(tree.parent[j], below[j].empty() ? -1 : *below[j].begin()) << k << ", " << j;
    }
  }
}

// Every column belongs to a supernode whose columns are a path up the tree; the order takes each
// supernode once, children first; together they are stored without losing an entry.
TEST(SupernodalTree, SupernodesAreConnectedAndComeAfterTheirChildren) {
  Random random(2);
  int merged = 0;
  for (int k = 0; k < 60; ++k) {
    const int n = static_cast<int>(random.integer(1, 60));
    const Pattern upper = random_pattern(n, random.uniform(0, 3), random);
    const EliminationTree tree = elimination_tree(upper);
    const std::vector<int> last = merge_columns(tree);
    ASSERT_EQ(static_cast<int>(last.size()), n);
    for (int j = 0; j < n; ++j) {
      EXPECT_GE(last[j], j);
      EXPECT_EQ(last[last[j]], last[j]) << "the last stands for itself";
      merged += last[j] != j;
      if (last[j] != j) {
        ASSERT_GE(tree.parent[j], 0);
        EXPECT_EQ(last[tree.parent[j]], last[j]) << "the parent is in the same supernode";
      }
    }
    const std::vector<int> order = supernode_order(tree.parent, last);
    std::vector<int> place(n, -1);
    for (std::size_t i = 0; i < order.size(); ++i) {
      EXPECT_EQ(last[order[i]], order[i]);
      EXPECT_EQ(place[order[i]], -1) << "once";
      place[order[i]] = static_cast<int>(i);
    }
    for (int j = 0; j < n; ++j) {
      ASSERT_GE(place[last[j]], 0);
      if (tree.parent[j] >= 0) {
        EXPECT_LE(place[last[j]], place[last[tree.parent[j]]]) << "children before parents";
      }
    }
    std::size_t entries = static_cast<std::size_t>(n);
    for (const std::set<int>& column : eliminated(upper)) entries += column.size();
    SupernodalFactors factors;
    factors.analyse(upper);
    EXPECT_GE(factors.stored(), entries);
  }
  EXPECT_GT(merged, 100) << "or nothing was merged";
}

// A band is one chain; a diagonal is a forest of single columns; a dense matrix is one supernode.
TEST(SupernodalTree, KnownTrees) {
  std::vector<std::pair<int, int>> band, dense;
  for (int i = 0; i < 9; ++i) band.emplace_back(i, i + 1);
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < i; ++j) dense.emplace_back(i, j);
  const EliminationTree chain = elimination_tree(pattern_of(10, band));
  EXPECT_EQ(chain.parent, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, -1}));
  EXPECT_EQ(chain.below, (std::vector<int>{1, 1, 1, 1, 1, 1, 1, 1, 1, 0}));
  const EliminationTree alone = elimination_tree(pattern_of(3, {}));
  EXPECT_EQ(alone.parent, (std::vector<int>{-1, -1, -1}));
  EXPECT_EQ(merge_columns(alone), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(merge_columns(elimination_tree(pattern_of(10, dense))), std::vector<int>(10, 9));
  EXPECT_TRUE(supernode_order({}, {}).empty());
}

}  // namespace
}  // namespace lapwing
