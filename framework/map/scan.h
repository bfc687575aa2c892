// SPDX-License-Identifier: Apache-2.0
// Depth images as the points that maps integrate.
#pragma once

#include <vector>

#include "framework/geometry/depth_image.h"

namespace lapwing {

// The measured points in the world, of every `pixel_step`-th pixel of every such row from the first
// on, row by row: computed in double precision, then rounded to single. A pixel without a hit
// (infinite depth) gives a point along its ray just beyond `maximum_range`, so that a map clears
// the ray and hits nothing; pixels without a measurement give none.
//
// InputError: no pinhole; an image with another number of pixels; a depth that is negative or NaN;
// a pose with a number that is not finite or an orientation that is no unit quaternion (to 1e-3);
// infinite depth without a finite maximum range.
void scan_points(const PosedDepthImage& measured, int pixel_step, double maximum_range,
                 double resolution, std::vector<Eigen::Vector3f>& points_W);

}  // namespace lapwing
