// SPDX-License-Identifier: Apache-2.0
// A room of free voxels with a wall, to look at and to fly in.
#pragma once

#include "framework/geometry/mesh_builder.h"
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

}  // namespace lapwing
