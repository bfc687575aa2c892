// SPDX-License-Identifier: Apache-2.0
#include "framework/app/plan_surfaces.h"

#include "framework/core/error.h"
#include "framework/geometry/mesh_file.h"
#include "framework/shape/shape.h"

namespace lapwing {

void open_surfaces(Environment& environment, const Registry& registry,
                   const std::filesystem::path& folder) {
  for (Obstacle& obstacle : environment.obstacles) {
    if (obstacle.shape || obstacle.triangles) continue;
    try {
      const Value* file = obstacle.parameters.find("file");
      if (!file)
        obstacle.shape = registry.create<Shape>(obstacle.type, obstacle.parameters);
      else if (obstacle.type == "mesh")
        obstacle.triangles =
            std::make_shared<TriangleMesh>(read_mesh(folder / file->as_text()).mesh);
    } catch (const InputError&) {
      continue;
    }
  }
}

}  // namespace lapwing
