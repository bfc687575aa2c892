// Pictures of maps and of depth images.
#pragma once

#include "framework/geometry/render.h"
#include "framework/map/map.h"

namespace lapwing {

// Looking down: the highest occupied voxel of every column by its height, lit from the north-west;
// free columns light, unknown ones dark. At most `most_pixels` across and up; columns share a pixel
// where the map is larger. Nothing (0 x 0) of a map without a known voxel.
struct MapPicture {
  Picture picture;
  double lowest = 0, highest = 0;  // m, heights at both ends of the colours
  double metres = 0;               // edge of what one square of it shows
};
MapPicture height_picture(const Map& map, int most_pixels);
// A level cut through the voxels at `height`: occupied dark, free light, unknown grey.
MapPicture cut_picture(const Map& map, double height, int most_pixels);
// The same cut by uncertainty (5.1): 0 light, 1 dark. For maps that count observations.
MapPicture uncertainty_picture(const Map& map, double height, int most_pixels);

// Near is bright; what has no measurement is black, what is beyond the range dark blue.
Picture depth_picture(const DepthImage& image);

}  // namespace lapwing
