// SPDX-License-Identifier: Apache-2.0
// Utilities that count along the rays of a view: what they share.
#pragma once

#include "framework/core/parameters.h"
#include "framework/explore/view_rays.h"

namespace lapwing {

// One ray per `pixel_step` columns and rows; views are valued one by one, by several threads.
class RayUtility : public ViewUtility {
 public:
  static ParameterTable parameters();
  explicit RayUtility(const Parameters& parameters);

 protected:
  // At least 0. Called from several threads at once.
  virtual double value_of(const EpisodeView& known, const Viewpoint& view) const = 0;

  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const final;
  // Directions of the rays; see view_rays.
  std::vector<Eigen::Vector3d> rays_of(const EpisodeView& known, const Viewpoint& view) const {
    return view_rays(view, known.pinhole, pixel_step_);
  }

 private:
  int pixel_step_;
};

}  // namespace lapwing
