// SPDX-License-Identifier: Apache-2.0
// A constraint: what must hold.
//
//   lower_k <= g_k(x_i, ..., x_{i+window-1}) <= upper_k,   lower == upper for an equation
//
// A constraint returns g and dg/dx (stage_function.h) and its bounds, which do not change once it
// is bound. Infinite bounds mean none.
#pragma once

#include "framework/problem/stage_function.h"

namespace lapwing {

class Constraint : public StageFunction {
 public:
  using Interface = Constraint;
  static constexpr const char* kKind = "constraint";

  // lower, upper: [count][rows].
  virtual void bounds(InstanceRange range, double* lower, double* upper) const = 0;
};

}  // namespace lapwing
