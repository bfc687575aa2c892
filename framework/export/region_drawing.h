// SPDX-License-Identifier: Apache-2.0
// A region of interest, drawn.
#pragma once

#include "framework/export/report.h"
#include "framework/geometry/interest_region.h"

namespace lapwing {

// Edges of a box, or of every prism and its holes, as lines named after the region; a weight other
// than 1 is part of the name. An empty region draws nothing.
void add_region(const InterestRegion& region, Drawing& drawing);

}  // namespace lapwing
