// SPDX-License-Identifier: Apache-2.0
// A room of free voxels with a wall, to look at and to fly in.
#pragma once

#include "framework/geometry/mesh_builder.h"
#include "framework/view/scan_graph.h"
#include "tests/map/small_map.h"

namespace lapwing {

// 20 m x 20 m x 10 m from (-10, -10, 0), known free but for a wall of one layer of voxels that
// begins at x = 5 and stands from y = -4 to 4 over the whole height; beyond all is unknown.
inline std::shared_ptr<SmallMap> walled_room() {
  auto map = std::make_shared<SmallMap>(0.5);
  std::vector<VoxelLeaf> leaves;
  const VoxelGrid& grid = map->grid();
  for (double x = -9.75; x < 10; x += 0.5)
    for (double y = -9.75; y < 10; y += 0.5)
      for (double z = 0.25; z < 10; z += 0.5) {
        const bool wall = x > 5 && x < 5.5 && std::abs(y) < 4;
        leaves.push_back({grid.key({x, y, z}), 0, 1, wall ? 2.0f : -2.0f});
      }
  map->import(leaves);
  return map;
}

// The face of the wall, as a mesh, moved along x.
inline std::shared_ptr<MeshScene> wall_face(double moved = 0) {
  TriangleMesh mesh;
  const double x = 5 + moved;
  mesh.vertices = {{x, -4, 0}, {x, 4, 0}, {x, 4, 10}, {x, -4, 10}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return std::make_shared<MeshScene>(mesh);
}

// Of a small camera that looks at a part of the wall.
inline SightSettings small_sight(const Eigen::AlignedBox3d& region) {
  SightSettings sight;
  sight.pinhole = {40, 30, 23, 23, 19.5, 14.5};
  sight.range = 30;
  sight.region = region;
  return sight;
}

// Of a graph of 40 views in the room.
inline ScanGraphSettings small_graph(const Eigen::AlignedBox3d& region) {
  ScanGraphSettings settings;
  settings.candidates.region = region;
  settings.candidates.allowed = {Eigen::Vector3d(-10, -10, 0), Eigen::Vector3d(10, 10, 10)};
  settings.candidates.half = {0.5, 0.5, 0.25};
  settings.candidates.most = 40;
  settings.motions.allowed = settings.candidates.allowed;
  settings.motions.half = settings.candidates.half;
  settings.coarse_across = 20;
  settings.threads = 2;
  return settings;
}

}  // namespace lapwing
