// SPDX-License-Identifier: Apache-2.0
// Rays through the bricks, four at a time.
#pragma once

#include <span>

#include "framework/map/map.h"
#include "plugins/maps/brick/brick_grid.h"

namespace lapwing::brick_map {

// The first voxel on each ray that is not free, as a walk voxel by voxel (ray_walk.h) finds it.
void cast_rays(const BrickGrid& bricks, const MapSettings& settings, std::span<const MapRay> rays,
               std::span<MapRayHit> hits);

}  // namespace lapwing::brick_map
