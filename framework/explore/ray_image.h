// SPDX-License-Identifier: Apache-2.0
// What a map says along the rays of a camera: an image of few rays, each with what it meets at the
// map's own resolution. The input of a learned utility.
//
// The free voxels up to the first one that is not free say little; what is behind it is told in
// segments that grow with the distance, so that a wall of one voxel and the room behind it are both
// told. Lengths are in voxels and shares, so that the input does not depend on the map's size.
#pragma once

#include <array>
#include <span>

#include "framework/core/value.h"
#include "framework/explore/view_utility.h"

namespace lapwing {

struct RayShape {
  static constexpr int kLeastRays = 2, kMostRays = 64;  // along an edge
  // Voxels behind the first one that is not free, at which segments end; the last ends with the
  // range.
  static constexpr std::array<int, 9> kEnds = {1, 2, 3, 4, 6, 8, 12, 16, 24};
  static constexpr int kSegments = static_cast<int>(kEnds.size()) + 1;
  static constexpr int kFirst = 6;  // numbers about the first voxel that is not free
  static constexpr int kOfSegment = 3;
  static constexpr int kChannels = kFirst + kOfSegment * kSegments;

  int columns = 20, rows = 15;  // the image is divided into so many cells, a ray through each

  int rays() const { return columns * rows; }
  std::size_t size() const { return static_cast<std::size_t>(rays()) * kChannels; }
  bool operator==(const RayShape&) const = default;
};
// InputError for another number of rays along an edge.
void require_sense(const RayShape& shape);
Value to_value(const RayShape& shape);
RayShape ray_shape_from(const Value& value);

// `image` has shape.size() places, each gets a number from 0 to 1: ray by ray, rows from above, of
// each ray
//   0  the distance to the first voxel that is not free, over the range; 1 where there is none
//   1  whether that voxel was never measured
//   2  its occupancy, 3 its occupancy times what is left to observe of it (5.1); else 0
//   4  what is left to observe of the free voxel before it, 5 of the one before that
// then of each segment behind it
//   +0 the share of voxels that were never measured, +1 the sum of occupancies over the voxels of
//   the segment, +2 the largest occupancy times what is left to observe.
// Voxels beyond the range count nothing. Thread-safe.
void sample_rays(const EpisodeView& known, const Viewpoint& view, const RayShape& shape,
                 std::span<float> image);

// Of a point in the frame of the camera (x right, y down, z ahead): the cell that shows it. What is
// outside of the image belongs to the nearest cell.
int ray_cell(const RayShape& shape, const Pinhole& pinhole, const Eigen::Vector3d& p_C);

}  // namespace lapwing
