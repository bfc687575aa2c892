// SPDX-License-Identifier: Apache-2.0
// What a viewer asks of a map: a layer of it as a picture, and the voxel that somebody points at.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "framework/map/map.h"

namespace lapwing {

// What is known of a cell. `between`: measured, but neither free nor occupied.
enum class CellState : std::uint8_t { unknown, free, occupied, between };

// A layer of a map, one voxel thick. The columns run along x, or along y where the layer stands
// across x; the rows along z, or along y where it lies across z.
struct MapSlice {
  int axis = 2;   // that it stands across: 0 is x, 1 is y, 2 is z
  int layer = 0;  // number of its voxels along that axis
  int level = 0;  // a cell has 2^level voxels either way
  // Numbers of the first voxel along columns and rows, and of cells.
  std::array<int, 2> first{};
  int columns = 0, rows = 0;
  // Row by row. A cell of several voxels is occupied where one of them is, else in between where
  // one is, else free where one is; its log odds is the largest of those that are known.
  std::vector<CellState> states;
  std::vector<float> log_odds;  // 0 where unknown
  // Voxels of the layer within the bounds of the map; what is left is unknown.
  std::uint64_t free = 0, occupied = 0, between = 0, unknown = 0;

  // The axes of columns and rows.
  int across() const { return axis == 0 ? 1 : 0; }
  int up() const { return axis == 2 ? 1 : 2; }
};

// The layer that holds `at` (m), from end to end of what is known, in cells so small that there are
// at most `most_cells`. InputError for a map that knows nothing, and for a place beyond its bounds,
// which the message states.
MapSlice slice_of(const Map& map, int axis, double at, std::size_t most_cells);

// The first occupied voxel on a ray from anywhere, as from an eye; nothing where there is none.
// `direction` is a unit vector.
std::optional<VoxelKey> first_occupied(const Map& map, const Eigen::Vector3d& origin,
                                       const Eigen::Vector3d& direction);

}  // namespace lapwing
