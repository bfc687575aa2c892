// SPDX-License-Identifier: Apache-2.0
// What the images of a tour will show of the prior mesh.
#include "framework/geometry/depth_camera.h"
#include "framework/mission/scan_record.h"

namespace lapwing {
namespace {

std::vector<Pose> poses_of(const std::vector<Viewpoint>& views) {
  std::vector<Pose> poses;
  for (const Viewpoint& v : views) poses.push_back(camera_pose(v.position, v.yaw, v.pitch));
  return poses;
}

ImagingSettings imaging_of(const ScanWork& work, double pixel_error) {
  const SightSettings& sight = work.visible->settings();
  return {sight.pinhole, std::min(sight.range, sight.usable_range), sight.usable_incidence,
          pixel_error};
}

std::vector<Viewpoint> chosen_from(const ScanWork& work, const std::vector<int>& views) {
  std::vector<Viewpoint> chosen;
  for (const int view : views)
    chosen.push_back(work.graph.candidates.viewpoints[static_cast<std::size_t>(view)]);
  return chosen;
}

}  // namespace

AccurateArea accurate_area(const ScanWork& work, const std::vector<int>& views, double accuracy,
                           double pixel_error, int threads) {
  const TriangleMesh& mesh = work.prior->mesh->mesh();
  const InterestRegion& region = work.visible->settings().region;
  std::vector<char> counted(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < counted.size(); ++t)
    counted[t] = region.contains((mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3);
  const ImageSet images(work.prior->mesh, poses_of(chosen_from(work, views)),
                        imaging_of(work, pixel_error));
  const auto predictions = predict_surface(images, counted, threads);
  AccurateArea area;
  for (std::size_t t = 0; t < counted.size(); ++t) {
    if (!counted[t]) continue;
    area.known += mesh.area(t);
    if (predictions[t].located() && predictions[t].accuracy <= accuracy)
      area.accurate += mesh.area(t);
  }
  return area;
}

ScanPrediction prediction_of_scan(const ScanWork& work, const std::vector<int>& views,
                                  std::vector<char> counted, double pixel_error, int threads) {
  const std::vector<Viewpoint>& all = work.graph.candidates.viewpoints;
  const ImagingSettings settings = imaging_of(work, pixel_error);
  ScanPrediction prediction;
  prediction.surface = work.prior->mesh;
  prediction.counted = std::move(counted);
  prediction.pixel_error = pixel_error;
  const ImageSet images(prediction.surface, poses_of(chosen_from(work, views)), settings);
  prediction.triangles = predict_surface(images, prediction.counted, threads);
  const ImageSet candidates(prediction.surface, poses_of(all), settings);
  std::optional<ImageSet> with_forbidden;
  if (!work.forbidden.empty()) {
    std::vector<Viewpoint> more = all;
    more.insert(more.end(), work.forbidden.begin(), work.forbidden.end());
    with_forbidden.emplace(prediction.surface, poses_of(more), settings);
  }
  prediction.holes = holes_of(*prediction.surface, prediction.counted, prediction.triangles,
                              candidates, with_forbidden ? &*with_forbidden : nullptr, threads);
  return prediction;
}

}  // namespace lapwing
