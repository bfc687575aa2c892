// SPDX-License-Identifier: Apache-2.0
// What can be asked of the grid.
#pragma once

#include <functional>
#include <optional>

#include "framework/map/map.h"
#include "framework/map/swept_box.h"
#include "plugins/maps/brick/brick_grid.h"

namespace lapwing::brick_map {

VoxelReading read_voxel(const BrickGrid& bricks, const MapSettings& settings, const VoxelKey& key);
bool sweep_free(const BrickGrid& bricks, const SweptBox& box);
MeanReading mean_of_cube(const BrickGrid& bricks, const MapSettings& settings, int level,
                         const VoxelKey& key);
void visit_leaves(const BrickGrid& bricks, const std::function<void(const VoxelLeaf&)>& visit);
std::optional<VoxelBox> known_box(const BrickGrid& bricks);
VoxelCounts count_voxels(const BrickGrid& bricks, const MapSettings& settings);

}  // namespace lapwing::brick_map
