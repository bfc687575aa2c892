// SPDX-License-Identifier: Apache-2.0
// Files of COLMAP models: whatever the bytes, finite poses and points, or an InputError. The first
// byte says which file they are, and whether it is binary.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/photogrammetry/colmap_depth.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  if (size == 0) return 0;
  const std::string_view given(reinterpret_cast<const char*>(data + 1), size - 1);
  const bool binary = data[0] & 4;
  try {
    switch (data[0] & 3) {
      case 0:
        for (const auto& [id, camera] : colmap_cameras(given, binary, "cameras")) {
          if (!(camera.pinhole().focal_x > 0)) std::abort();
          camera.direction({1, 1});
        }
        break;
      case 1:
        for (const ColmapImage& image : colmap_images(given, binary, "images"))
          if (!image.pose.position.allFinite()) std::abort();
        break;
      case 2:
        for (const ColmapPoint& point : colmap_points(given, binary, "points"))
          if (!point.position.allFinite()) std::abort();
        break;
      default: {
        const ColmapDepthMap map = read_colmap_depth_map(given, "map");
        if (map.depth.size() !=
            static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height))
          std::abort();
      }
    }
  } catch (const InputError&) {
  }
  return 0;
}
