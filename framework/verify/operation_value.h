// SPDX-License-Identifier: Apache-2.0
// What an operation of a stated constraint or of a motion's derivatives gives. Internal to this
// room.
#pragma once

#include <span>

#include "framework/trajectory/stated_constraint.h"

namespace lapwing {

// Of an operation on numbers alone: every one but `input`, `subject` and `distance`, which give not
// a number. `values` are the results of all operations before it.
double operation_value(const ConstraintStep& step, std::span<const double> values);

}  // namespace lapwing
