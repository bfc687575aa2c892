// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/maps/depth_frames.h"

#include <cstdlib>

#include "framework/geometry/depth_camera.h"
#include "framework/geometry/depth_folder.h"
#include "framework/mission/scene_script.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

MeshScene made_street() {
  MissionSettings settings;
  settings.scripts = LAPWING_SOURCE_DIR "/scripts";
  settings.configs = LAPWING_SOURCE_DIR "/configs";
  return MeshScene(
      generate_scene(settings.scripts / "scene" / "street.lua", Value::map(), settings).mesh);
}

}  // namespace

std::optional<fs::path> data_folder() {
  const char* named = std::getenv("LAPWING_DATA");
  const fs::path folder = named ? fs::path(named) : fs::path(LAPWING_SOURCE_DIR "/../shared/data");
  if (fs::is_directory(folder)) return folder;
  return std::nullopt;
}

std::vector<PosedDepthImage> real_frames(int count) {
  std::vector<PosedDepthImage> frames;
  const DepthFolder folder(*data_folder() / "depth");
  for (int k = 0; k < count; ++k) frames.push_back(folder.read(static_cast<std::size_t>(k)));
  return frames;
}

std::vector<PosedDepthImage> street_frames(int count, int width, int height) {
  static const MeshScene street = made_street();
  const Pinhole pinhole{
      width, height, width / 2.0, width / 2.0, width / 2.0 - 0.5, height / 2.0 - 0.5};
  std::vector<PosedDepthImage> frames;
  for (int k = 0; k < count; ++k) {
    const double heights[] = {1.8, 4, 7, 12, 18};
    const Pose camera = camera_pose({-42 + 84.0 * k / count, 2 * std::sin(1.7 * k), heights[k % 5]},
                                    2.4 * k, 0.1 - 0.15 * (k % 5));
    frames.push_back({camera, render_depth(street, camera, pinhole, 60, 1)});
  }
  return frames;
}

}  // namespace lapwing
