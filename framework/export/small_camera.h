// SPDX-License-Identifier: Apache-2.0
// Whether the images of a scan are large enough for what is to be made of them.
#pragma once

#include <string>

#include "framework/geometry/depth_image.h"

namespace lapwing {

// A sentence for images that no photogrammetry program finds enough features in, below 240 pixels
// along the shorter side; it names the options that give the real camera. "" for larger ones.
std::string warning_of_small_camera(const Pinhole& camera);

}  // namespace lapwing
