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

}  // namespace

ScanPrediction prediction_of_scan(const ScanWork& work, const std::vector<int>& views,
                                  std::vector<char> counted, double pixel_error, int threads) {
  const SightSettings& sight = work.visible->settings();
  const std::vector<Viewpoint>& all = work.graph.candidates.viewpoints;
  std::vector<Viewpoint> taken;
  for (const int view : views) taken.push_back(all[static_cast<std::size_t>(view)]);
  const ImagingSettings settings{sight.pinhole, std::min(sight.range, sight.usable_range),
                                 sight.usable_incidence, pixel_error};
  ScanPrediction prediction;
  prediction.surface = work.prior->mesh;
  prediction.counted = std::move(counted);
  prediction.pixel_error = pixel_error;
  const ImageSet images(prediction.surface, poses_of(taken), settings);
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
