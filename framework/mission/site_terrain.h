// SPDX-License-Identifier: Apache-2.0
// Sites from rasters of heights: the surface with all that stands on it, and the terrain.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "framework/geometry/height_grid.h"
#include "framework/mission/site_work.h"

namespace lapwing {

struct TerrainRequest {
  std::filesystem::path surface;                // heights of the surface
  std::optional<std::filesystem::path> ground;  // of the terrain, without buildings and plants
  std::string surface_name, ground_name;        // in messages
  StatedReference reference;                    // without what the data say
  std::optional<Eigen::AlignedBox2d> only;      // m, world: what lies outside is left out
  double resolution = 0.2, cell = 0.5;          // m, of the voxels and of the mesh
};

// What is under the surface is solid, down to the lowest height; above it there is air. A column of
// voxels ends at the highest of its corners' heights and of the middles of pixels within it, with
// the lines between those of neighbours, and nothing is known of columns with a corner without
// data. Heights between pixels are bilinear. The mesh has corners every `cell` metres, a
// whole number of voxels. InputError, naming the file: all that raster_info and refer_site refuse,
// a raster of more than 2^27 pixels within the region, a region without data. Cancelled.
Site read_site_terrain(const TerrainRequest& request, const MapWork& work);

}  // namespace lapwing
