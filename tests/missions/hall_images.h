// SPDX-License-Identifier: Apache-2.0
// Depth images of a hall with the errors of a sensor, in a world whose y points down.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "framework/geometry/depth_camera.h"
#include "framework/geometry/depth_folder.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/photogrammetry/similarity.h"

namespace lapwing {

inline void add_hall_box(TriangleMesh& mesh, const Eigen::Vector3d& low,
                         const Eigen::Vector3d& high) {
  const Eigen::AlignedBox3d box(low, high);
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)));
  for (const auto& [a, b, c, d] : std::vector<std::array<std::int32_t, 4>>{
           {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  }
}

inline void write_hall_images(const std::filesystem::path& folder) {
  TriangleMesh mesh;
  add_hall_box(mesh, {-6, -5, 0}, {6, 5, 4});    // the hall
  add_hall_box(mesh, {-1, -1, 0}, {1, 1, 1.5});  // what stands in it
  const MeshScene scene(std::move(mesh), "hall");
  // World to that of the files: z up becomes y down.
  Similarity turn;
  turn.rotation = Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX());
  for (int k = 0; k < 16; ++k) {
    const double angle = 2 * EIGEN_PI * k / 16;
    const Eigen::Vector3d place(2.6 * std::cos(angle), 2.6 * std::sin(angle), 2);
    const Pose camera = camera_pose(place, angle + (k % 2 ? EIGEN_PI : 0), -0.25);
    const Pinhole pinhole{120, 90, 70, 70, 59.5, 44.5};
    PosedDepthImage image{camera, render_depth(scene, camera, pinhole, 30, 1)};
    add_noise(image.image, {.dropped = 0.2, .sigma = 0.01}, static_cast<std::uint64_t>(k));
    image.camera.position = turn.rotation * camera.position;
    image.camera.orientation = turn.rotation * camera.orientation;
    char name[8];
    std::snprintf(name, sizeof name, "%02d", k);
    write_depth_frame(folder, name, image);
  }
}

}  // namespace lapwing
