// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/map_work.h"

#include <chrono>

namespace lapwing {
namespace {

constexpr std::size_t kShownImages = 6;

// One image into the map; every so many are kept for the report.
void integrate(Mapping& mapping, PosedDepthImage measured, std::size_t index, std::size_t count) {
  const auto begin = std::chrono::steady_clock::now();
  mapping.map->integrate(measured);
  mapping.seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++mapping.scans;
  const std::size_t every = (count + kShownImages - 1) / kShownImages;
  if (index % every == 0) mapping.images.push_back(std::move(measured));
}

// Whether to go on with image `index`.
bool goes_on(Mapping& mapping, const MapWork& work, std::size_t index, std::size_t count) {
  if (work.cancellation && work.cancellation->cancelled()) mapping.cancelled = true;
  if (mapping.cancelled) return false;
  if (work.progress)
    work.progress->report(
        static_cast<double>(index) / static_cast<double>(count),
        "depth image " + std::to_string(index + 1) + " of " + std::to_string(count));
  return true;
}

}  // namespace

void map_surface(Mapping& mapping, const MeshScene& surface, const std::vector<Pose>& poses,
                 const DepthSensor& sensor, std::uint64_t seed, const MapWork& work) {
  mapping.map->set_threads(work.threads);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!goes_on(mapping, work, i, poses.size())) return;
    PosedDepthImage measured{
        poses[i], render_depth(surface, poses[i], sensor.pinhole, sensor.range, work.threads)};
    if (sensor.noise) add_noise(measured.image, *sensor.noise, seed + i);
    integrate(mapping, std::move(measured), i, poses.size());
  }
}

void map_folder(Mapping& mapping, const DepthFolder& folder, const MapWork& work) {
  mapping.map->set_threads(work.threads);
  for (std::size_t i = 0; i < folder.size(); ++i) {
    if (!goes_on(mapping, work, i, folder.size())) return;
    integrate(mapping, folder.read(i), i, folder.size());
  }
}

}  // namespace lapwing
