// SPDX-License-Identifier: Apache-2.0
// What an episode does to its map beside its images, for the explorer and for whoever repeats it.
#pragma once

#include "framework/explore/ground_truth.h"
#include "framework/map/map.h"

namespace lapwing {

// All voxels of the box become free, and are as uncertain as before.
VoxelBox clear_box(Map& map, const Eigen::AlignedBox3d& box);

// Where the body is there is nothing else, whatever a noisy image says: a box of this edge (m)
// around the view becomes free where it is not. The box that was changed.
std::optional<VoxelBox> clear_body(Map& map, const Viewpoint& view, double body);

}  // namespace lapwing
