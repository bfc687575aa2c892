// SPDX-License-Identifier: Apache-2.0
// What a map looks like around a camera: grids of several scales, turned with the camera (thesis
// 5.4.3, figure 5.3). The input of a learned utility.
#pragma once

#include <span>

#include "framework/core/value.h"
#include "framework/explore/view_utility.h"

namespace lapwing {

// Points of the grid at level l = 1, ..., levels are 2^l voxels apart, around the camera.
struct GridShape {
  static constexpr int kLeastPoints = 2, kMostPoints = 64;  // along an edge

  int across = 16, ahead = 16, up = 8;  // points along the camera's right, forward and up
  int levels = 3;

  int channels() const { return 2 * levels; }
  int points() const { return across * ahead * up; }
  std::size_t size() const {
    return static_cast<std::size_t>(points()) * static_cast<std::size_t>(channels());
  }
  bool operator==(const GridShape&) const = default;
};
// InputError for another number of points along an edge, and for levels outside 1 to
// MapMeans::kMostLevels.
void require_sense(const GridShape& shape);
Value to_value(const GridShape& shape);
GridShape grid_shape_from(const Value& value);

// `grid` has shape.size() places: point by point, right fastest, then forward, then up; of each
// point the occupancy and uncertainty (reading 5.4) of level 1, then 2 and so on, interpolated
// between the middles of cubes along three axes. The means must be refreshed to shape.levels.
// Thread-safe.
void sample_grid(const EpisodeView& known, const Viewpoint& view, const GridShape& shape,
                 std::span<float> grid);

// All that a grid depends on besides the map's voxels: edge and update rule of the map, the
// camera. A model is good for one of these alone (reading 5.2).
Value mapping_of(const EpisodeView& known);
// What keeps a value from being such a mapping: "it has no pitch"; empty where nothing does.
std::string mapping_fault(const Value& value);
// The first difference, as "resolution is 0.2, the model's 0.4"; empty where there is none.
std::string mapping_difference(const Value& given, const Value& expected);

}  // namespace lapwing
