// SPDX-License-Identifier: Apache-2.0
// The depth camera of an exploration, simulated: true depth, noisy depth, stereo (thesis 5.5.5).
// And what is done with its depth before it is mapped.
#pragma once

#include <cstdint>
#include <optional>

#include "framework/geometry/depth_camera.h"
#include "framework/geometry/depth_smoothing.h"
#include "framework/geometry/stereo_depth.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

struct ViewSensor {
  Pinhole pinhole;
  double range = 20;  // m
  std::optional<DepthNoise> noise = std::nullopt;
  std::optional<StereoOptions> stereo = std::nullopt;
  double smooth_to = 0;  // m, to which `noise` is smoothed; 0: it is not

  // The image from there; `seed` is of its noise. Stereo comes first, noise on top of it.
  PosedDepthImage measure(const MeshScene& scene, const Viewpoint& view, std::uint64_t seed,
                          int threads) const {
    PosedDepthImage image{view.camera(), {}};
    image.image = stereo ? stereo_depth(scene, image.camera, pinhole, range, *stereo, threads)
                         : render_depth(scene, image.camera, pinhole, range, threads);
    if (noise) add_noise(image.image, *noise, seed);
    return image;
  }
  // Before it is mapped. The thesis does nothing here. Errors of stereo stay: neighbours share
  // them.
  void smooth(PosedDepthImage& measured, int threads) const {
    if (noise) smooth_depth(measured.image, noise->sigma, smooth_to, threads);
  }
  // Without noise.
  PosedDepthImage look(const MeshScene& scene, const Viewpoint& view, int threads) const {
    const Pose camera = view.camera();
    return {camera, render_depth(scene, camera, pinhole, range, threads)};
  }
};

}  // namespace lapwing
