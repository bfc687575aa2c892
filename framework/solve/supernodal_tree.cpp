// SPDX-License-Identifier: Apache-2.0
// How:
//   elimination_tree   For every column j, start at each entry i < j and follow parents until a
//                      column that was reached for this j already. A column without a parent gets
//                      j. Every column passed has an entry of L in row j, so `below` counts them
//                      exactly (Liu, "The role of elimination trees in sparse factorization",
//                      1990). The time is that of the number of entries of L.
//   merge_columns      Relaxed supernodes (Ashcraft and Grimes 1989): a child is merged with its
//                      parent where the model `cost` says that one panel of both is cheaper than
//                      two, the stored zeros included. Children with most rows come first, as they
//                      add fewest zeros.
//   supernode_order    Postorder of the tree of supernodes, without recursion: a child comes before
//                      its parent, so that its update matrix is on top of the stack.
#include "framework/solve/supernodal_tree.h"

#include <algorithm>
#include <numeric>

namespace lapwing {
namespace {

// Cost of a supernode, in multiply-adds of the dense kernels.
constexpr double kOfNode = 50.0;  // loops begun and ended
constexpr double kOfColumn = 20.0;
constexpr double kOfAssembly = 3.0;  // an entry of the update matrix: scattered into the parent
constexpr double kOfEntry = 8.0;  // an entry of the panel: some backsolves for each factorisation

double cost(double width, double below) {
  const auto squares = [](double k) { return k * (k + 1) * (2 * k + 1) / 6; };
  return kOfNode + kOfColumn * width + 0.5 * (squares(width + below) - squares(below)) +
         kOfAssembly * 0.5 * below * (below + 1) + kOfEntry * width * (0.5 * width + below);
}

// Lists of the children of each column, in order.
struct Children {
  std::vector<int> first, next;
  explicit Children(const std::vector<int>& parent)
      : first(parent.size(), -1), next(parent.size(), -1) {
    for (int j = static_cast<int>(parent.size()) - 1; j >= 0; --j)
      if (parent[j] >= 0) {
        next[j] = first[parent[j]];
        first[parent[j]] = j;
      }
  }
};

}  // namespace

EliminationTree elimination_tree(const Eigen::SparseMatrix<double>& upper) {
  const int n = static_cast<int>(upper.cols());
  EliminationTree tree{std::vector<int>(n, -1), std::vector<int>(n, 0)};
  std::vector<int> seen(n, -1);
  const int* const outer = upper.outerIndexPtr();
  const int* const inner = upper.innerIndexPtr();
  for (int j = 0; j < n; ++j) {
    seen[j] = j;
    for (int k = outer[j]; k < outer[j + 1]; ++k)
      for (int i = inner[k]; i < j && seen[i] != j; i = tree.parent[i]) {
        if (tree.parent[i] < 0) tree.parent[i] = j;
        ++tree.below[i];
        seen[i] = j;
      }
  }
  return tree;
}

std::vector<int> merge_columns(const EliminationTree& tree) {
  const int n = static_cast<int>(tree.parent.size());
  std::vector<int> last(n), width(n, 1), candidates;
  std::iota(last.begin(), last.end(), 0);
  const Children children(tree.parent);
  for (int j = 0; j < n; ++j) {
    candidates.clear();
    for (int c = children.first[j]; c >= 0; c = children.next[c]) candidates.push_back(c);
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](int a, int b) { return tree.below[a] > tree.below[b]; });
    for (int c : candidates)
      if (cost(width[c] + width[j], tree.below[j]) <
          cost(width[c], tree.below[c]) + cost(width[j], tree.below[j])) {
        last[c] = j;
        width[j] += width[c];
      }
  }
  for (int j = n - 1; j >= 0; --j) last[j] = last[last[j]];
  return last;
}

std::vector<int> supernode_order(const std::vector<int>& parent, const std::vector<int>& last) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> of_node(n, -1);
  for (int j = 0; j < n; ++j)
    if (last[j] == j && parent[j] >= 0) of_node[j] = last[parent[j]];
  Children children(of_node);
  std::vector<int> order, path;
  for (int root = 0; root < n; ++root) {
    if (last[root] != root || of_node[root] >= 0) continue;
    path.push_back(root);
    while (!path.empty()) {
      const int j = path.back(), c = children.first[j];
      if (c >= 0) {
        children.first[j] = children.next[c];
        path.push_back(c);
      } else {
        order.push_back(j);
        path.pop_back();
      }
    }
  }
  return order;
}

}  // namespace lapwing
