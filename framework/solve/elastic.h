// SPDX-License-Identifier: Apache-2.0
// The elastic form of a quadratic program whose rows or bounds contradict each other.
//
//   minimise  x'Px/2 + c'x + penalty * (sum of p + sum of q)   with   lower <= A x + p - q <= upper
//
// It always has a solution. Where the program has one too and the penalty exceeds its multipliers,
// the solutions are the same; else the violations p, q are the least in sum, and the multipliers of
// what stays hard say what stands in the way.
#pragma once

#include <vector>

#include "framework/solve/quadratic_program.h"

namespace lapwing {

struct ElasticProgram {
  QuadraticProgram program;  // variables: x, then p and q per relaxed row
  int variables = 0;         // of the original
  std::vector<int> relaxed;  // original rows, in the order of p and q; row m + i is bound i
};

// Relaxes rows from `first_row` on, and with `bounds` the bounds on variables too.
ElasticProgram make_elastic(const QuadraticProgram& problem, int first_row, bool bounds,
                            double penalty);

}  // namespace lapwing
