// SPDX-License-Identifier: Apache-2.0
// The distance to everything that is in the way, as an expression.
#pragma once

#include <string>

#include "framework/problem/expression_graph.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

// Metres from the point (x, y, z), three nodes, to the nearest obstacle that the flight is to keep
// out of, negative inside; of those named `name`, unless that is empty. The nearest is chosen by
// value, rounded within `width` (tape_operation.h). InputError where there is none, naming those
// that there are, or where one moves or its shape was not opened.
int nearest_distance(ExpressionGraph& graph, const Environment& environment,
                     const std::string& name, const int (&point)[3], double width);

}  // namespace lapwing
