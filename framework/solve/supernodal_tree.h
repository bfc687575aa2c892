// SPDX-License-Identifier: Apache-2.0
// Which columns of L D L' factors go together, and in which order. Internal to the room.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

namespace lapwing {

// The elimination tree and the entries below the diagonal of each column of L.
struct EliminationTree {
  std::vector<int> parent, below;
};

// `upper`: the pattern on and above the diagonal.
EliminationTree elimination_tree(const Eigen::SparseMatrix<double>& upper);

// Which column stands for the supernode of each: the last of it. A child goes into its parent where
// one larger block costs less than two, fullest children first.
std::vector<int> merge_columns(const EliminationTree& tree);

// `last` of merge_columns: columns that stand for supernodes, children before parents and next to
// them.
std::vector<int> supernode_order(const std::vector<int>& parent, const std::vector<int>& last);

}  // namespace lapwing
