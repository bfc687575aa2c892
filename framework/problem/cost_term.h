// SPDX-License-Identifier: Apache-2.0
// A cost term: how bad a trajectory is, as residuals.
//
//   cost = weight * sum over instances of || r_k(x_i, ..., x_{i+window-1}) ||^2
//
// A term returns r and dr/dx (stage_function.h); the kernel owns the weight, squares, sums, and
// forms the quadratic model: H = 2 w J'J (Gauss-Newton) or with 2 w sum r d2r (exact), g = 2 w J'r.
#pragma once

#include "framework/problem/stage_function.h"

namespace lapwing {

class CostTerm : public StageFunction {
 public:
  using Interface = CostTerm;
  static constexpr const char* kKind = "cost_term";
};

}  // namespace lapwing
