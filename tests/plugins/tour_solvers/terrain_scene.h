// SPDX-License-Identifier: Apache-2.0
// Made-up scan problems: views over a terrain of blocks, voxels with normals (thesis 4.4.2, 4.4.4).
#pragma once

#include <cstdint>

#include "framework/view/tour_problem.h"

namespace lapwing {

struct TerrainOptions {
  int views = 600;
  double size = 60;     // m, of the square region
  int blocks = 12;      // buildings
  double voxel = 1.0;   // m
  double budget = 300;  // s
  int neighbours = 12;  // motions per view
};

// Surface voxels of a height field of blocks; views at random free places above it that look down
// at random; a voxel's contribution is (4.7) where nothing of the terrain stands between. Motions
// at 3 m/s to the nearest views, 3 s a view, a loop from the first.
TourDefinition terrain_tour(std::uint64_t seed, const TerrainOptions& options);

}  // namespace lapwing
