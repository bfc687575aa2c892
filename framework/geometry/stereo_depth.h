// SPDX-License-Identifier: Apache-2.0
// Depth as a pair of cameras measures it: both pictures rendered with a texture, matched by
// semi-global matching (thesis 5.5.5). OpenCV does the matching.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/geometry/depth_camera.h"

namespace lapwing {

struct GreyPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // rows from the top
};

struct StereoOptions {
  double baseline = 0.5;  // m, the right camera is so far along the left one's x
  double nearest = 1;     // m, nearer things are not matched
  int block = 5;          // pixels, side of the squares compared; odd
};

// The mesh under a soft light, in its colours, with bumps of brightness of 5 cm to 3 m that belong
// to places of the world: the same place looks alike from everywhere. Beyond `range` there is a
// bright sky without texture. As render_depth otherwise.
GreyPicture render_textured(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                            double range, int threads);

// Depth in the left picture; 0 where no match was found, infinity where both pictures show the same
// texture in the same place. Throws InputError for pictures that differ in size from the pinhole
// and for options without sense.
DepthImage match_stereo(const GreyPicture& left, const GreyPicture& right, const Pinhole& pinhole,
                        const StereoOptions& options);

// All of it, for a left camera at `camera`, under a sky with faint clouds, infinitely far;
// infinity, as of render_depth, where the match lies beyond `range`.
DepthImage stereo_depth(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                        double range, const StereoOptions& options, int threads);

}  // namespace lapwing
