// SPDX-License-Identifier: Apache-2.0
// How, in the terms of the multifrontal method:
//   1. analyse: the elimination tree gives the pattern of L. Neighbouring columns of similar
//      pattern are merged into supernodes (supernodal_tree.h). A supernode has a dense panel: its
//      columns, by its own rows and the rows below. Children come before parents.
//   2. factorise, one supernode after the other: put the entries of the matrix into the panel, add
//      the update matrices of the children (assemble), factor the panel densely (eliminate), and
//      compute its own update matrix - L21 D L21' for the parent (update, assemble).
//   3. solve: forward through all panels, divide by the pivots, backward through all panels.
//
// Update matrices are on two stacks, by the parity of the depth in the tree. A parent writes to one
// stack while it reads its children from the other, so nothing is moved. A supernode of one column
// without children stores no update matrix: its parent multiplies the column out (`thin`).
// Inner loops take two target columns and up to four source columns at once and keep the factors in
// registers. The templates over the number of columns exist for that.
#include "framework/solve/supernodal_factors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "framework/solve/supernodal_tree.h"

namespace lapwing {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Eigen::Index;

// Two numbers that the compiler keeps in one register.
using Pair = double __attribute__((vector_size(16)));

Pair load(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}

// (y0, y1) -= the sum over k of column k of l, times c0[k], c1[k]; instead of += where `begin`.
template <int kColumns, bool kBegin>
void subtract(double* __restrict y0, double* __restrict y1, const double* __restrict l,
              std::ptrdiff_t stride, const double* c0, const double* c1, int count) {
  double a[kColumns], b[kColumns];
  for (int k = 0; k < kColumns; ++k) {
    a[k] = c0[k];
    b[k] = c1[k];
  }
  for (int i = 0; i < count; ++i) {
    double s0 = l[i] * a[0], s1 = l[i] * b[0];
    for (int k = 1; k < kColumns; ++k) {
      s0 += l[k * stride + i] * a[k];
      s1 += l[k * stride + i] * b[k];
    }
    if (kBegin) {
      y0[i] = -s0;
      y1[i] = -s1;
    } else {
      y0[i] -= s0;
      y1[i] -= s1;
    }
  }
}

template <bool kBegin>
void subtract_some(int columns, double* y0, double* y1, const double* l, std::ptrdiff_t stride,
                   const double* c0, const double* c1, int count) {
  switch (columns) {
    case 1:
      return subtract<1, kBegin>(y0, y1, l, stride, c0, c1, count);
    case 2:
      return subtract<2, kBegin>(y0, y1, l, stride, c0, c1, count);
    case 3:
      return subtract<3, kBegin>(y0, y1, l, stride, c0, c1, count);
    default:
      return subtract<4, kBegin>(y0, y1, l, stride, c0, c1, count);
  }
}

// All `columns` of them, four at a time; the first four overwrite y where `begin`.
void subtract_all(bool begin, int columns, double* y0, double* y1, const double* l,
                  std::ptrdiff_t stride, const double* c0, const double* c1, int count) {
  int k = 0;
  if (begin) {
    subtract_some<true>(columns, y0, y1, l, stride, c0, c1, count);
    k = 4;
  }
  for (; k < columns; k += 4)
    subtract_some<false>(columns - k, y0, y1, l + k * stride, stride, c0 + k, c1 + k, count);
}

// Solves with kColumns columns of unit lower triangular l: x holds their numbers, then those of
// `below` rows, which lose what the columns say.
template <int kColumns>
void forward_columns(double* __restrict x, const double* __restrict l, std::ptrdiff_t stride,
                     int below) {
  double c[kColumns];
  for (int k = 0; k < kColumns; ++k) {
    c[k] = x[k];
    for (int i = 0; i < k; ++i) c[k] -= l[i * stride + k] * c[i];
    x[k] = c[k];
  }
  for (int i = kColumns; i < kColumns + below; ++i) {
    double sum = l[i] * c[0];
    for (int k = 1; k < kColumns; ++k) sum += l[k * stride + i] * c[k];
    x[i] -= sum;
  }
}

// The transposed step. Even and odd rows are summed apart, side by side.
template <int kColumns>
void backward_columns(double* __restrict x, const double* __restrict l, std::ptrdiff_t stride,
                      int below) {
  Pair sums[kColumns] = {};
  double c[kColumns];
  int i = kColumns;
  for (; i + 2 <= kColumns + below; i += 2) {
    const Pair both = load(x + i);
    for (int k = 0; k < kColumns; ++k) sums[k] += load(l + k * stride + i) * both;
  }
  for (int k = 0; k < kColumns; ++k) c[k] = x[k] - (sums[k][0] + sums[k][1]);
  if (i < kColumns + below)
    for (int k = 0; k < kColumns; ++k) c[k] -= l[k * stride + i] * x[i];
  for (int k = kColumns - 1; k >= 0; --k) {
    for (int r = k + 1; r < kColumns; ++r) c[k] -= l[k * stride + r] * c[r];
    x[k] = c[k];
  }
}

// Both steps of a whole supernode of few columns, straight from and to the numbers v of its rows.
template <int kColumns>
void forward_narrow(double* v, double* own, const double* l, std::ptrdiff_t stride, const int* rows,
                    int below) {
  double c[kColumns];
  for (int k = 0; k < kColumns; ++k) {
    c[k] = own[k];
    for (int i = 0; i < k; ++i) c[k] -= l[i * stride + k] * c[i];
    own[k] = c[k];
  }
  l += kColumns;
  for (int i = 0; i < below; ++i) {
    double sum = l[i] * c[0];
    for (int k = 1; k < kColumns; ++k) sum += l[k * stride + i] * c[k];
    v[rows[i]] -= sum;
  }
}

template <int kColumns>
void backward_narrow(const double* v, double* own, const double* l, std::ptrdiff_t stride,
                     const int* rows, int below) {
  double c[kColumns];
  for (int k = 0; k < kColumns; ++k) c[k] = own[k];
  const double* const under = l + kColumns;
  for (int i = 0; i < below; ++i) {
    const double x = v[rows[i]];
    for (int k = 0; k < kColumns; ++k) c[k] -= under[k * stride + i] * x;
  }
  for (int k = kColumns - 1; k >= 0; --k) {
    for (int r = k + 1; r < kColumns; ++r) c[k] -= l[k * stride + r] * c[r];
    own[k] = c[k];
  }
}

}  // namespace

void SupernodalFactors::analyse(const Matrix& upper) {
  const int n = static_cast<int>(upper.cols());
  const EliminationTree tree = elimination_tree(upper);
  const std::vector<int> last = merge_columns(tree);
  const std::vector<int> order = supernode_order(tree.parent, last);
  std::vector<int> node_of(n);
  nodes_.assign(order.size(), {});
  for (int s = 0; s < static_cast<int>(order.size()); ++s) node_of[order[s]] = s;
  for (int j = 0; j < n; ++j) ++nodes_[node_of[last[j]]].width;
  int first = 0;
  for (Supernode& node : nodes_) {
    node.first = first;
    first += node.width;
  }
  place_.resize(n);
  std::vector<int> used(nodes_.size(), 0);
  for (int j = 0; j < n; ++j) {
    const int s = node_of[last[j]];
    place_[j] = nodes_[s].first + used[s]++;
  }
  for (int s = static_cast<int>(nodes_.size()) - 1; s >= 0; --s) {
    const int parent = tree.parent[order[s]];
    if (parent < 0) continue;
    Supernode& above = nodes_[node_of[last[parent]]];
    nodes_[s].stack = 1 - above.stack;
    nodes_[s].sibling = above.child;
    above.child = s;
  }
  lay_out(upper);
  lay_out_stacks();
  shapes_.clear();
  for (const Supernode& node : nodes_) shapes_.push_back({node.width, node.below});
  ordered_.assign(n, 0.0);
  pivots_.assign(n, 0.0);
  inverse_pivots_.assign(n, 0.0);
}

// Rows of each supernode, and where each entry and each child's row goes.
void SupernodalFactors::lay_out(const Matrix& upper) {
  const int n = static_cast<int>(upper.cols());
  const int* const outer = upper.outerIndexPtr();
  const int* const inner = upper.innerIndexPtr();
  std::vector<int> node_at(n);  // of each place
  for (int s = 0; s < static_cast<int>(nodes_.size()); ++s)
    std::fill_n(node_at.begin() + nodes_[s].first, nodes_[s].width, s);
  std::vector<int> column(upper.nonZeros()), row(upper.nonZeros());  // of each entry, in places
  std::vector<int> begin(nodes_.size() + 1, 0);
  for (int j = 0; j < n; ++j)
    for (int k = outer[j]; k < outer[j + 1]; ++k) {
      column[k] = std::min(place_[inner[k]], place_[j]);
      row[k] = std::max(place_[inner[k]], place_[j]);
      ++begin[node_at[column[k]] + 1];
    }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (std::size_t s = 0; s < nodes_.size(); ++s) nodes_[s].entries = begin[s];
  entry_source_.resize(column.size());
  entry_destination_.resize(column.size());
  for (int k = 0; k < static_cast<int>(column.size()); ++k)
    entry_source_[begin[node_at[column[k]]]++] = k;

  rows_.clear();
  inside_.clear();
  std::size_t panels = 0;
  int tallest = 0;
  std::vector<int> seen(n, -1), local(n);
  for (int s = 0; s < static_cast<int>(nodes_.size()); ++s) {
    Supernode& node = nodes_[s];
    const int end = node.first + node.width;
    node.rows = static_cast<int>(rows_.size());
    node.panel = panels;
    const auto add = [&](int i) {
      if (i < end || seen[i] == s) return;
      seen[i] = s;
      rows_.push_back(i);
    };
    for (int e = node.entries; e < begin[s]; ++e) add(row[entry_source_[e]]);
    for (int c = node.child; c >= 0; c = nodes_[c].sibling)
      for (int k = 0; k < nodes_[c].below; ++k) add(rows_[nodes_[c].rows + k]);
    std::sort(rows_.begin() + node.rows, rows_.end());
    node.below = static_cast<int>(rows_.size()) - node.rows;
    panels += static_cast<std::size_t>(node.height()) * node.width;
    tallest = std::max(tallest, node.height());
    inside_.resize(rows_.size());
    for (int k = 0; k < node.width; ++k) local[node.first + k] = k;
    for (int k = 0; k < node.below; ++k) local[rows_[node.rows + k]] = node.width + k;
    for (int e = node.entries; e < begin[s]; ++e) {
      const int k = entry_source_[e];
      entry_destination_[e] = (column[k] - node.first) * node.height() + local[row[k]];
    }
    for (int c = node.child; c >= 0; c = nodes_[c].sibling) {
      Supernode& child = nodes_[c];
      for (int k = 0; k < child.below; ++k) {
        inside_[child.rows + k] = local[rows_[child.rows + k]];
        child.in_parent += rows_[child.rows + k] < end;
      }
    }
  }
  panels_.assign(panels, 0.0);
  first_.assign(tallest, 0.0);
  second_.assign(tallest, 0.0);
}

void SupernodalFactors::lay_out_stacks() {
  std::size_t top[2] = {0, 0}, most[2] = {0, 0};
  for (Supernode& node : nodes_) {
    std::size_t& mine = top[node.stack];
    node.update = mine;
    mine += static_cast<std::size_t>(node.below) * node.below;
    most[node.stack] = std::max(most[node.stack], mine);
    if (node.child >= 0) top[1 - node.stack] = nodes_[node.child].update;
  }
  for (int k = 0; k < 2; ++k) stacks_[k].assign(most[k], 0.0);
}

// Adds the children's update matrices: what falls into the panel, or what falls below it.
void SupernodalFactors::assemble(const Supernode& node, bool panel) {
  const std::ptrdiff_t height = node.height();
  for (int c = node.child; c >= 0; c = nodes_[c].sibling) {
    const Supernode& child = nodes_[c];
    const int* const inside = inside_.data() + child.rows;
    const int begin = panel ? 0 : child.in_parent, end = panel ? child.in_parent : child.below;
    const bool thin = child.thin();
    const double* const l = panels_.data() + child.panel + child.width;
    const std::ptrdiff_t stride = panel ? height : node.below;
    double* const base = panel
                             ? panels_.data() + node.panel
                             : stacks_[node.stack].data() + node.update - node.width * (stride + 1);
    const double* from = stacks_[child.stack].data() + child.update +
                         static_cast<std::ptrdiff_t>(begin) * child.below;
    for (int j = begin; j < end; j += 2, from += 2 * child.below) {
      const bool two = j + 1 < end;
      double* const to0 = base + inside[j] * stride;
      double* const to1 = two ? base + inside[j + 1] * stride : to0;
      if (thin) {
        const double factor0 = l[j] * pivots_[child.first];
        to0[inside[j]] -= l[j] * factor0;
        if (two) {
          const double factor1 = l[j + 1] * pivots_[child.first];
          for (int i = j + 1; i < child.below; ++i) {
            const int k = inside[i];
            to0[k] -= l[i] * factor0;
            to1[k] -= l[i] * factor1;
          }
        } else {
          for (int i = j + 1; i < child.below; ++i) to0[inside[i]] -= l[i] * factor0;
        }
        continue;
      }
      to0[inside[j]] += from[j];
      if (two) {
        for (int i = j + 1; i < child.below; ++i) {
          const int k = inside[i];
          to0[k] += from[i];
          to1[k] += from[child.below + i];
        }
      } else {
        for (int i = j + 1; i < child.below; ++i) to0[inside[i]] += from[i];
      }
    }
  }
}

// Factors the panel, two columns at a time, each pair first less what the columns before it say.
bool SupernodalFactors::eliminate(const Supernode& node) {
  const std::ptrdiff_t height = node.height();
  double* const panel = panels_.data() + node.panel;
  double* const pivots = pivots_.data() + node.first;
  double* const inverses = inverse_pivots_.data() + node.first;
  if (node.width == 1) {
    const double inverse = 1.0 / panel[0];
    pivots[0] = panel[0];
    inverses[0] = inverse;
    for (int i = 1; i < height; ++i) panel[i] *= inverse;
    return std::isfinite(pivots[0]) && std::isfinite(inverse);
  }
  for (int j = 0; j < node.width; j += 2) {
    const bool two = j + 1 < node.width;
    double* const l0 = panel + j * height;
    double* const l1 = two ? l0 + height : second_.data();
    for (int k = 0; k < j; ++k) {
      first_[k] = pivots[k] * panel[k * height + j];
      second_[k] = two ? pivots[k] * panel[k * height + j + 1] : 0.0;
    }
    const int count = static_cast<int>(height) - j;
    if (two)
      subtract_all(false, j, l0 + j, l1 + j, panel + j, height, first_.data(), second_.data(),
                   count);
    else
      for (int k = 0; k < j; ++k)
        for (int i = j; i < height; ++i) l0[i] -= panel[k * height + i] * first_[k];
    pivots[j] = l0[j];
    inverses[j] = 1.0 / l0[j];
    if (!std::isfinite(pivots[j]) || !std::isfinite(inverses[j])) return false;
    const double inverse0 = inverses[j];
    if (!two) {
      for (int i = j + 1; i < height; ++i) l0[i] *= inverse0;
      continue;
    }
    const double across = l0[j + 1] * inverse0;
    pivots[j + 1] = l1[j + 1] - l0[j + 1] * across;
    inverses[j + 1] = 1.0 / pivots[j + 1];
    if (!std::isfinite(pivots[j + 1]) || !std::isfinite(inverses[j + 1])) return false;
    const double inverse1 = inverses[j + 1];
    l0[j + 1] = across;
    double* __restrict const p0 = l0;
    double* __restrict const p1 = l1;
    for (int i = j + 2; i < height; ++i) {
      p1[i] = (p1[i] - p0[i] * across) * inverse1;
      p0[i] *= inverse0;
    }
  }
  return true;
}

// The update matrix (its lower triangle): - L21 D L21'.
void SupernodalFactors::update(const Supernode& node) {
  const std::ptrdiff_t height = node.height();
  const double* const pivots = pivots_.data() + node.first;
  const double* const panel = panels_.data() + node.panel + node.width;
  double* const matrix = stacks_[node.stack].data() + node.update;
  for (int j = 0; j < node.below; j += 2) {
    const bool two = j + 1 < node.below;
    for (int k = 0; k < node.width; ++k) {
      first_[k] = pivots[k] * panel[k * height + j];
      second_[k] = two ? pivots[k] * panel[k * height + j + 1] : 0.0;
    }
    double* const y0 = matrix + static_cast<std::ptrdiff_t>(j) * node.below;
    double unused;
    subtract_all(true, node.width, y0 + j, two ? y0 + node.below + j : &unused, panel + j, height,
                 first_.data(), second_.data(), node.below - j);
  }
}

bool SupernodalFactors::factorise(const Matrix& upper) {
  const double* const values = upper.valuePtr();
  int entry = 0;
  for (std::size_t s = 0; s < nodes_.size(); ++s) {
    const Supernode& node = nodes_[s];
    std::fill_n(panels_.data() + node.panel, static_cast<std::size_t>(node.height()) * node.width,
                0.0);
    const int end =
        s + 1 < nodes_.size() ? nodes_[s + 1].entries : static_cast<int>(entry_source_.size());
    double* const panel = panels_.data() + node.panel;
    for (; entry < end; ++entry) panel[entry_destination_[entry]] = values[entry_source_[entry]];
    assemble(node, true);
    if (!eliminate(node)) return false;
    if (node.below == 0 || node.thin()) continue;
    update(node);
    assemble(node, false);
  }
  return true;
}

int SupernodalFactors::negative_pivots() const {
  return static_cast<int>(
      std::count_if(pivots_.begin(), pivots_.end(), [](double pivot) { return pivot < 0; }));
}

void SupernodalFactors::solve(Eigen::VectorXd& x) {
  const int n = static_cast<int>(place_.size());
  double* const v = ordered_.data();
  for (int j = 0; j < n; ++j) v[place_[j]] = x(j);
  const double* panel = panels_.data();
  const int* rows = rows_.data();
  double* own = v;
  for (const Shape& shape : shapes_) {
    forward(shape, panel, rows, own);
    panel += static_cast<std::ptrdiff_t>(shape.width + shape.below) * shape.width;
    rows += shape.below;
    own += shape.width;
  }
  for (int j = 0; j < n; ++j) v[j] *= inverse_pivots_[j];
  for (auto shape = shapes_.rbegin(); shape != shapes_.rend(); ++shape) {
    panel -= static_cast<std::ptrdiff_t>(shape->width + shape->below) * shape->width;
    rows -= shape->below;
    own -= shape->width;
    backward(*shape, panel, rows, own);
  }
  for (int j = 0; j < n; ++j) x(j) = v[place_[j]];
}

void SupernodalFactors::forward(Shape shape, const double* l, const int* rows, double* own) {
  const int width = shape.width, below = shape.below, height = width + below;
  double* const v = ordered_.data();
  switch (width) {
    case 1:
      return forward_narrow<1>(v, own, l, height, rows, below);
    case 2:
      return forward_narrow<2>(v, own, l, height, rows, below);
    case 3:
      return forward_narrow<3>(v, own, l, height, rows, below);
    case 4:
      return forward_narrow<4>(v, own, l, height, rows, below);
    default:
      break;
  }
  double* const x = first_.data();
  std::copy_n(own, width, x);
  for (int i = 0; i < below; ++i) x[width + i] = v[rows[i]];
  const int odd = width % 4;
  if (odd == 1) forward_columns<1>(x, l, height, height - 1);
  if (odd == 2) forward_columns<2>(x, l, height, height - 2);
  if (odd == 3) forward_columns<3>(x, l, height, height - 3);
  for (int k = odd; k < width; k += 4)
    forward_columns<4>(x + k, l + k * (height + 1), height, height - k - 4);
  std::copy_n(x, width, own);
  for (int i = 0; i < below; ++i) v[rows[i]] = x[width + i];
}

void SupernodalFactors::backward(Shape shape, const double* l, const int* rows, double* own) {
  const int width = shape.width, below = shape.below, height = width + below;
  double* const v = ordered_.data();
  switch (width) {
    case 1:
      return backward_narrow<1>(v, own, l, height, rows, below);
    case 2:
      return backward_narrow<2>(v, own, l, height, rows, below);
    case 3:
      return backward_narrow<3>(v, own, l, height, rows, below);
    case 4:
      return backward_narrow<4>(v, own, l, height, rows, below);
    default:
      break;
  }
  double* const x = first_.data();
  std::copy_n(own, width, x);
  for (int i = 0; i < below; ++i) x[width + i] = v[rows[i]];
  const int odd = width % 4;
  for (int k = width - 4; k >= 0; k -= 4)
    backward_columns<4>(x + k, l + k * (height + 1), height, height - k - 4);
  if (odd == 1) backward_columns<1>(x, l, height, height - 1);
  if (odd == 2) backward_columns<2>(x, l, height, height - 2);
  if (odd == 3) backward_columns<3>(x, l, height, height - 3);
  std::copy_n(x, width, own);
}

}  // namespace lapwing
