// SPDX-License-Identifier: Apache-2.0
// What surrounds a flight, drawn: obstacles, zones and the outlines of meshes.
#pragma once

#include <filesystem>

#include "framework/export/report.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// The surface of an obstacle without its moves. Of its shape, if that is open: round surfaces to
// within 2 % of its size, what has no end within 10 m of the flight. Else the triangles that the
// plan records, or those of the mesh that it names in `folder`. Empty where there are none.
TriangleMesh drawn_surface(const Obstacle& obstacle, const Plan& plan,
                           const std::filesystem::path& folder);

// What flights stay inside of as outlines, at floor and ceiling or, where one is missing, at the
// lowest and the highest of the path. What has no inside as its sharp edges, unless there are more
// than 3000; a mesh whose shape was not opened from its file in `folder`. Other obstacles by what
// their shapes say of themselves; those whose shape was not opened by the triangles that the plan
// records, if any. Obstacles that move are drawn where they begin.
void add_surroundings(const Plan& plan, const std::filesystem::path& folder, Drawing& drawing);

}  // namespace lapwing
