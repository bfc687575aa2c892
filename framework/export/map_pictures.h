// SPDX-License-Identifier: Apache-2.0
// Pictures of maps and of depth images.
#pragma once

#include <limits>
#include <vector>

#include "framework/map/map.h"
#include "framework/picture/render.h"

namespace lapwing {

struct MapPicture {
  Picture picture;
  double lowest = 0, highest = 0;  // m, heights at both ends of the colours
  double metres = 0;               // edge of what one square of it shows
};

// The columns of a map's voxels: of each the highest occupied one, or whether it has a free one.
// Small beside the map: what it was can be drawn when it has grown.
struct MapColumns {
  static constexpr std::uint16_t kNone = 0;  // the last voxel that a map could have

  VoxelBox box;  // of the voxels that are free or occupied
  VoxelGrid grid{1};
  std::vector<std::uint16_t> top;  // its key; north to south, in each row west to east
  std::vector<bool> free;
  bool empty() const { return top.empty(); }
};
// Voxels above `below` (m) are left out: a room without its ceiling.
MapColumns map_columns(const Map& map, double below = std::numeric_limits<double>::infinity());

// Looking down: the highest occupied voxel of every column by its height, lit from the north-west;
// free columns light, unknown ones dark. At most `most_pixels` across and up; columns share a pixel
// where the map is larger. Nothing (0 x 0) of a map without a known voxel.
MapPicture height_picture(const Map& map, int most_pixels);
// Within the frame, and by the colours, of other columns: of the same map when it had grown.
MapPicture height_picture(const MapColumns& columns, const MapColumns& frame, int most_pixels);
// A level cut through the voxels at `height`: occupied dark, free light, unknown grey.
MapPicture cut_picture(const Map& map, double height, int most_pixels);
// The same cut by uncertainty (5.1): 0 light, 1 dark. For maps that count observations.
MapPicture uncertainty_picture(const Map& map, double height, int most_pixels);

// Near is bright; what has no measurement is black, what is beyond the range dark blue.
Picture depth_picture(const DepthImage& image);

}  // namespace lapwing
