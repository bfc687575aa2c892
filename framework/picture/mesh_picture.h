// SPDX-License-Identifier: Apache-2.0
// Pictures of meshes by daylight: scenes as a user would look at them.
#pragma once

#include <memory>

#include "framework/geometry/camera_view.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/picture/render.h"

namespace lapwing {

// One sun with hard shadows, a sky, haze; triangles in their own colours, or grey. Four rays a
// pixel; rows are shared among threads, and the bytes are the same for any number. Throws
// InputError when the view has no pixel or more than 100 million.
Picture mesh_picture(const MeshScene& scene, const CameraView& view, int threads);

// What a picture is drawn of, for one that may never be asked for. `scene` is not null.
struct SceneView {
  std::shared_ptr<const MeshScene> scene;
  CameraView view;
};

// A camera that has all of the box in view, from the direction of yaw and pitch (rad; pitch
// negative looks down).
CameraView overview(const Eigen::AlignedBox3d& box, const Pinhole& pinhole, double yaw,
                    double pitch);

}  // namespace lapwing
