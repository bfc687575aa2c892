// SPDX-License-Identifier: Apache-2.0
// The report page of a scene: what it is made of, and what it looks like.
#pragma once

#include <string>

#include "framework/export/report.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/geometry/pose.h"
#include "framework/picture/render.h"

namespace lapwing {

// What a camera sees of a mesh by daylight, without shadows: the triangles' own colours (light grey
// where it has none), darker where the sun does not fall. Throws as check_camera does.
Picture surface_picture(const MeshScene& scene, const Pose& camera, const Pinhole& pinhole,
                        int threads);

struct SceneReport {
  std::string title;
  std::string origin;          // of the mesh, for the summary: "Collada, 0.0254 m a unit, ..."
  Eigen::AlignedBox3d region;  // of interest; empty: none
  int threads = 1;
};

// Four views from the corners, one from above.
Report scene_report(const MeshScene& scene, const SceneReport& given);

}  // namespace lapwing
