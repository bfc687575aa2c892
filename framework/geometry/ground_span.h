// SPDX-License-Identifier: Apache-2.0
// How high the ground is within a polygon.
#pragma once

#include <optional>

#include "framework/geometry/height_grid.h"
#include "framework/geometry/interest_region.h"

namespace lapwing {

struct GroundSpan {
  double lowest = 0, highest = 0;  // m, world
};

// The span of the ground within a simple polygon: of all grid points inside, and of those around
// its edges (tried every quarter of a step), so that heights between grid points do not lie beyond
// it. Nothing where none of these points is known; others that are not known do not count.
std::optional<GroundSpan> ground_span(const HeightGrid& ground, const GroundPolygon& polygon);

}  // namespace lapwing
