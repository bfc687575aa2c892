// SPDX-License-Identifier: Apache-2.0
#include "framework/export/small_camera.h"

#include <algorithm>

namespace lapwing {

std::string warning_of_small_camera(const Pinhole& camera) {
  constexpr int kLeast = 240;  // pixels
  if (std::min(camera.width, camera.height) >= kLeast) return "";
  return "the camera has " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
         " pixels: no photogrammetry program makes a model from such images (" +
         std::to_string(kLeast) +
         " along the shorter side are the minimum). Plan with the real camera: camera.width, "
         "camera.height and camera.focal (all in pixels)";
}

}  // namespace lapwing
