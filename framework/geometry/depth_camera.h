// SPDX-License-Identifier: Apache-2.0
// What a camera sees of a mesh: depth, normals, triangles; and what a real sensor makes of depth.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/geometry/depth_image.h"
#include "framework/geometry/mesh_scene.h"

namespace lapwing {

// Towards a pixel, in the camera's frame (x right, y down, z forward), with z = 1.
Eigen::Vector3d pixel_ray(const Pinhole& pinhole, double x, double y);
// Unit vectors through all pixels, tile by tile of 8 x 8 from the upper left, row by row in each:
// neighbours in the list are neighbours in the image both ways, which is how a map casts a view
// quickest.
std::vector<Eigen::Vector3d> tiled_pixel_rays(const Pinhole& pinhole);
// A camera that looks along yaw and pitch (rad, positive up), its image level.
Pose camera_pose(const Eigen::Vector3d& position, double yaw, double pitch);

// Pixel by pixel, as in the depth image.
struct MeshView {
  DepthImage depth;
  std::vector<std::int32_t> triangles;   // -1 where there is nothing within range
  std::vector<Eigen::Vector3f> normals;  // unit, world, towards the camera; zero where nothing
};

// Throws InputError for a pinhole without pixels or focal lengths and a range that is not above 0.
void check_camera(const Pinhole& pinhole, double range);

// One ray through the middle of every pixel. Where it meets nothing whose depth is at most `range`
// metres the depth is infinite. Rows are shared among threads (core/parallel.h); the image is the
// same for any number. Throws as check_camera does.
DepthImage render_depth(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                        double range, int threads);
MeshView render_view(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                     double range, int threads);

// Thesis 5.5.5 (table 5.4): low, medium, high and very high are sigma 0.1, 0.2, 0.5 and 1 m, each
// with 40 % of the pixels dropped.
struct DepthNoise {
  double dropped = 0.4;  // share of pixels that become 0, "no measurement"
  double sigma = 0.1;    // m, normal, added to the depth of those that stay
};

// A pixel depends on the seed and its own place alone; a depth that would not be above 0 becomes 0,
// infinity stays unless dropped. Throws InputError for a share outside [0, 1] or a negative sigma.
void add_noise(DepthImage& image, const DepthNoise& noise, std::uint64_t seed);

}  // namespace lapwing
