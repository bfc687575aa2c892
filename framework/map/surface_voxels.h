// SPDX-License-Identifier: Apache-2.0
// The voxels that a surface of triangles goes through: what a map of it would hold at best.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "framework/map/voxel.h"

namespace lapwing {

// Every voxel that a triangle meets (thesis 5.4.2: the ground truth), each once, in the order of
// keys. A voxel holds its three lower faces, so that a wall that stands exactly between two voxels
// belongs to one of them, as a point on it does. World frame, metres.
//
// InputError: a corner that is not finite or lies outside the largest map (naming the triangle), an
// index out of range; more than `most` voxels.
std::vector<VoxelKey> surface_voxels(std::span<const Eigen::Vector3d> vertices_W,
                                     std::span<const std::array<std::int32_t, 3>> triangles,
                                     double resolution, std::size_t most = std::size_t{1} << 28);

}  // namespace lapwing
