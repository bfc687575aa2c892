// SPDX-License-Identifier: Apache-2.0
// The nearest convex quadratic form.
#pragma once

#include <vector>

namespace lapwing {

// Takes the negative eigenvalues of symmetric matrices, each width x width, one after another in
// `blocks`, as zero: the nearest positive semidefinite ones in the Frobenius norm (Higham, Linear
// Algebra Appl. 103, 1988). Matrices of zeros cost nothing.
void take_convex_parts(std::vector<double>& blocks, int width);

}  // namespace lapwing
