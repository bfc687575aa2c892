// SPDX-License-Identifier: Apache-2.0
// Structure from motion, for real: textured photographs at planned views, and how many of them
// COLMAP registers into one model, which is what (4.8) of the thesis promises.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/core/progress.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {

struct Registered {
  int images = 0;
  int largest = 0;  // of them in the largest model
  int models = 0;
};

// InputError saying how to get it, where there is no program `colmap` on the path.
void require_colmap();

// Writes `folder`/images/view_0001.png and so on, of the surface with a texture of its own
// (evaluation alone may see it), and runs COLMAP there on the CPU: features, matches of all pairs,
// mapper. What it says goes to colmap.log. InputError naming the step that failed; Cancelled when
// told to stop, and COLMAP is ended.
Registered register_photos(const MeshScene& surface, const std::vector<Pose>& cameras,
                           const Pinhole& pinhole, const std::filesystem::path& folder, int threads,
                           const CancellationToken* cancellation);

}  // namespace lapwing
