// SPDX-License-Identifier: Apache-2.0
// What mapping missions have the kernel do: look at surfaces, and put what was seen into a map.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/progress.h"
#include "framework/geometry/depth_camera.h"
#include "framework/geometry/depth_folder.h"
#include "framework/map/map.h"

namespace lapwing {

// A map being made, and what the report shows of its making.
struct Mapping {
  std::string plugin;
  std::shared_ptr<Map> map;
  std::string source;                   // "50 depth images of folder 'depth'"
  std::vector<PosedDepthImage> images;  // a few of those that went in
  std::size_t scans = 0;
  bool cancelled = false;  // before all of them were in
  double seconds = 0;      // wall clock of integration alone
};

// How a view of a surface is measured.
struct DepthSensor {
  Pinhole pinhole;
  double range = 0;  // m
  std::optional<DepthNoise> noise;
};

struct MapWork {
  int threads = 1;
  const CancellationToken* cancellation = nullptr;
  Progress* progress = nullptr;
};

// When cancelled they end between two images, and the map holds those before. InputError as
// render_depth and Map::integrate.
void map_surface(Mapping& mapping, const MeshScene& surface, const std::vector<Pose>& poses,
                 const DepthSensor& sensor, std::uint64_t seed, const MapWork& work);
void map_folder(Mapping& mapping, const DepthFolder& folder, const MapWork& work);

}  // namespace lapwing
