// SPDX-License-Identifier: Apache-2.0
// A scene of a plain hut on level ground, for missions of a test's folder.
#pragma once

#include <filesystem>

#include "framework/core/files.h"

namespace lapwing {

inline void write_hut_scene(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "scene");
  write_file_atomically(folder / "scene/hut.lua", R"(
return function(options)
  local scene = lapwing.scene { name = "hut", seed = options.seed }
  scene:quad({-30, -30, 0}, {30, -30, 0}, {30, 30, 0}, {-30, 30, 0})
  scene:box({-4, -3, 0}, {4, 3, 4})
  scene:region({-6, -5, -0.4}, {6, 5, 7})
  return scene
end
)");
}

}  // namespace lapwing
