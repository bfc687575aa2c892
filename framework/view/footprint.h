// SPDX-License-Identifier: Apache-2.0
// What an image shows of level ground.
#pragma once

#include <vector>

#include "framework/view/viewpoint.h"

namespace lapwing {

// The corners, in order, of the part of the level z = `level` (m) that a depth image shows, whose
// depths are at most `range` (m): four where the camera looks down, up to five where the range or
// the horizon cuts some off, none where the image shows no ground. InputError as check_camera.
std::vector<Eigen::Vector2d> footprint_of(const Viewpoint& view, const Pinhole& pinhole,
                                          double level, double range);

}  // namespace lapwing
