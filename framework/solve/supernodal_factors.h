// SPDX-License-Identifier: Apache-2.0
// L D L' factors of a sparse symmetric quasi-definite matrix, in dense blocks of columns. Internal
// to the room.
//
// Multifrontal method (Duff and Reid 1983) with supernodes, relaxed as in Ashcraft and Grimes 1989,
// but by a model of the cost. No pivoting: a quasi-definite matrix has such factors in every order
// (Vanderbei 1995), with pivots of either sign.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/SparseCore>

namespace lapwing {

class SupernodalFactors {
 public:
  // `upper`: square, compressed; entries on and above the diagonal, in the elimination order
  // wanted. Only its pattern counts.
  void analyse(const Eigen::SparseMatrix<double>& upper);
  // Takes new values in the pattern analysed. False at a zero or non-finite pivot; then there is
  // nothing to solve with.
  bool factorise(const Eigen::SparseMatrix<double>& upper);
  // x becomes the solution of L D L' x = x given.
  void solve(Eigen::VectorXd& x);
  // Of the last factors: as many as the matrix has negative eigenvalues (Sylvester).
  int negative_pivots() const;
  // Stored numbers of L, those of the diagonal and explicit zeros included.
  std::size_t stored() const { return panels_.size(); }

 private:
  // Columns [first, first + width) have their entries in the same rows: their own, then those in
  // rows_[rows .. rows + below). The panel holds them column by column, width + below numbers each.
  struct Supernode {
    int first = 0, width = 0, below = 0;
    int child = -1, sibling = -1;  // first child, next sibling
    int in_parent = 0;             // how many of the rows are columns of the parent
    int stack = 0;
    int rows = 0, entries = 0;          // beginnings in rows_ and inside_, in entry_*_
    std::size_t panel = 0, update = 0;  // beginnings in panels_ and in the stack
    int height() const { return width + below; }
    // Has no update matrix of its own: its parent multiplies it out.
    bool thin() const { return width == 1 && child < 0; }
  };
  // What a solve needs of them, packed.
  struct Shape {
    int width, below;
  };
  void lay_out(const Eigen::SparseMatrix<double>& upper);
  void lay_out_stacks();
  void assemble(const Supernode& node, bool panel);
  bool eliminate(const Supernode& node);
  void update(const Supernode& node);
  void forward(Shape shape, const double* l, const int* rows, double* own);
  void backward(Shape shape, const double* l, const int* rows, double* own);

  std::vector<Supernode> nodes_;  // children before parents
  std::vector<Shape> shapes_;
  std::vector<int> place_;              // of each column given, in the order used here
  std::vector<int> rows_, inside_;      // of each supernode: rows below; their places in the parent
  std::vector<int> entry_source_;       // entries by supernode: which value
  std::vector<int> entry_destination_;  // and where in the panel
  std::vector<double> panels_, pivots_, inverse_pivots_;
  std::vector<double> stacks_[2];  // update matrices, by parity of depth: a parent's does not
                                   // overwrite its children's, and needs no moving
  std::vector<double> ordered_, first_, second_;  // scratch
};

}  // namespace lapwing
