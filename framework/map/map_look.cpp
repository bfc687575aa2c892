// SPDX-License-Identifier: Apache-2.0
#include "framework/map/map_look.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/map/ray_walk.h"

namespace lapwing {
namespace {

constexpr const char* kAxes[3] = {"x", "y", "z"};

CellState state_of(const MapSettings& settings, float log_odds) {
  switch (settings.state(log_odds)) {
    case VoxelState::free:
      return CellState::free;
    case VoxelState::occupied:
      return CellState::occupied;
    case VoxelState::unknown:
      break;
  }
  return CellState::between;
}

// What counts more in a cell of several voxels.
int rank_of(CellState state) {
  switch (state) {
    case CellState::unknown:
      return 0;
    case CellState::free:
      return 1;
    case CellState::between:
      return 2;
    case CellState::occupied:
      break;
  }
  return 3;
}

// The whole cells of a slice that lies within these bounds.
void lay_out(const VoxelBox& bounds, std::size_t most_cells, MapSlice& slice) {
  const int low[2] = {bounds.lower[slice.across()], bounds.lower[slice.up()]};
  const int high[2] = {bounds.upper[slice.across()], bounds.upper[slice.up()]};
  const auto cells = [&](int i) { return (high[i] >> slice.level) - (low[i] >> slice.level) + 1; };
  while (static_cast<std::size_t>(cells(0)) * static_cast<std::size_t>(cells(1)) > most_cells &&
         slice.level < kTreeDepth)
    ++slice.level;
  slice.columns = cells(0);
  slice.rows = cells(1);
  for (std::size_t i = 0; i < 2; ++i) slice.first[i] = low[i] >> slice.level << slice.level;
  const auto count = static_cast<std::size_t>(slice.columns) * static_cast<std::size_t>(slice.rows);
  slice.states.assign(count, CellState::unknown);
  slice.log_odds.assign(count, 0);
}

// The part of a leaf that lies in the layer.
void add_leaf(const VoxelLeaf& leaf, CellState state, MapSlice& slice) {
  const int size = 1 << leaf.level, from = leaf.key[slice.axis];
  if (slice.layer < from || slice.layer >= from + size) return;
  const auto voxels = static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size);
  (state == CellState::free       ? slice.free
   : state == CellState::occupied ? slice.occupied
                                  : slice.between) += voxels;
  const auto first_cell = [&](int axis, std::size_t i) {
    return (leaf.key[axis] - slice.first[i]) >> slice.level;
  };
  const auto last_cell = [&](int axis, std::size_t i) {
    return (leaf.key[axis] + size - 1 - slice.first[i]) >> slice.level;
  };
  for (int row = first_cell(slice.up(), 1); row <= last_cell(slice.up(), 1); ++row)
    for (int column = first_cell(slice.across(), 0); column <= last_cell(slice.across(), 0);
         ++column) {
      const auto place = static_cast<std::size_t>(row) * static_cast<std::size_t>(slice.columns) +
                         static_cast<std::size_t>(column);
      CellState& had = slice.states[place];
      float& odds = slice.log_odds[place];
      odds = had == CellState::unknown ? leaf.log_odds : std::max(odds, leaf.log_odds);
      if (rank_of(state) > rank_of(had)) had = state;
    }
}

}  // namespace

MapSlice slice_of(const Map& map, int axis, double at, std::size_t most_cells) {
  const std::optional<VoxelBox> bounds = map.bounds();
  if (!bounds) throw InputError("slice: the map knows nothing yet");
  const VoxelGrid& grid = map.grid();
  const double low = grid.face(bounds->lower[axis]), high = grid.face(bounds->upper[axis] + 1);
  if (!(at >= low && at <= high))
    throw InputError("slice: " + std::string(kAxes[axis]) + " = " + plain_number(at, 6) +
                     " m lies outside of the map, which reaches from " + plain_number(low, 6) +
                     " to " + plain_number(high, 6) + " m");
  MapSlice slice;
  slice.axis = axis;
  // The upper face belongs to the last layer.
  slice.layer = std::clamp<int>(grid.index(at), bounds->lower[axis], bounds->upper[axis]);
  lay_out(*bounds, most_cells, slice);
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    add_leaf(leaf, state_of(map.settings(), leaf.log_odds), slice);
  });
  const auto voxels = [&](int along) {
    return static_cast<std::uint64_t>(bounds->upper[along] - bounds->lower[along] + 1);
  };
  slice.unknown =
      voxels(slice.across()) * voxels(slice.up()) - slice.free - slice.occupied - slice.between;
  return slice;
}

std::optional<VoxelKey> first_occupied(const Map& map, const Eigen::Vector3d& origin,
                                       const Eigen::Vector3d& direction) {
  const std::optional<VoxelBox> bounds = map.bounds();
  if (!bounds) return std::nullopt;
  const VoxelGrid& grid = map.grid();
  const Eigen::Vector3d low = grid.corner(bounds->lower);
  const Eigen::Vector3d high(grid.face(bounds->upper.x + 1), grid.face(bounds->upper.y + 1),
                             grid.face(bounds->upper.z + 1));
  double enters = 0, leaves = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double a = (low[i] - origin[i]) / direction[i], b = (high[i] - origin[i]) / direction[i];
    // Along a face without moving across it: not a number, and no bound.
    if (std::isnan(a) || std::isnan(b)) continue;
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  if (!(enters <= leaves)) return std::nullopt;
  // A hair inside, where rounding has left it outside.
  const double hair = 1e-9 * grid.resolution();
  const Eigen::Vector3d start = (origin + enters * direction)
                                    .cwiseMax((low.array() + hair).matrix())
                                    .cwiseMin((high.array() - hair).matrix());
  for (RayWalk walk(grid, start, direction);
       walk.inside() && bounds->contains(walk.key()) && enters + walk.entered <= leaves;
       walk.advance())
    if (map.read(walk.key()).state == VoxelState::occupied) return walk.key();
  return std::nullopt;
}

}  // namespace lapwing
