// SPDX-License-Identifier: Apache-2.0
// Depth images and points with normals from a COLMAP model, in its own frame and units.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/photogrammetry/colmap_model.h"
#include "framework/photogrammetry/depth_source.h"
#include "framework/surface/point_fusion.h"

namespace lapwing {

struct ColmapDepth {
  std::shared_ptr<const DepthSource> source;  // null without an image that shows anything
  bool dense = false;                         // from depth maps, not from points alone
  std::string described;                      // "12 geometric depth maps"
};

// From the depth maps of `folder`/stereo/depth_maps where there are any (geometric ones, or
// photometric ones where there are only those; images without one are left out), else from the
// points of the model: each shows in the images in which COLMAP found it, in the nearest pixel of
// an image of at most 160 by 160 pixels. Lens distortion is undone. InputError naming a file that
// is none or is cut short, when it is read.
ColmapDepth depth_of_colmap(const ColmapModel& model, const std::filesystem::path& folder);

// The bytes of a depth map: "width&height&channels&", then floats, row by row. InputError,
// beginning with `name`, where they are not so.
struct ColmapDepthMap {
  int width = 0, height = 0;
  std::vector<float> depth;
};
ColmapDepthMap read_colmap_depth_map(std::string_view bytes, const std::string& name);

// The points of the model that at least three images see, with normals: of the plane through their
// 12 nearest neighbours, on the side of the cameras that see them. Points with neighbours ten times
// as far away as usual are left out.
std::vector<FusedPoint> surface_of_colmap(const ColmapModel& model);

// fused.ply of COLMAP's stereo fusion: x, y, z, nx, ny, nz as floats, then colours. InputError
// naming the file.
std::vector<FusedPoint> read_fused_points(const std::filesystem::path& file);

// The mean of the points in every cube of `spacing`, in the order of the cubes.
std::vector<FusedPoint> thinned(const std::vector<FusedPoint>& points, double spacing);

}  // namespace lapwing
