// SPDX-License-Identifier: Apache-2.0
// What a view tells of a voxel that it sees. The plugin kind `information`.
//
// The kernel sums the contributions of all views of a tour and saturates the sum at 1 (thesis 4.4),
// so that whatever a plugin answers, the score of a tour is monotone and submodular.
#pragma once

#include <optional>
#include <span>

#include "framework/core/plugin_object.h"
#include "framework/map/voxel.h"

namespace lapwing {

// A voxel as one view sees it.
struct VoxelSight {
  float distance = 0;              // m, camera to the voxel's centre
  float pixels = 0;                // that the voxel's edge takes in the image when seen squarely
  std::optional<float> incidence;  // rad, ray against the surface's normal; absent: not known
};

class ViewInformation : public PluginObject {
 public:
  using Interface = ViewInformation;
  static constexpr const char* kKind = "information";
  virtual ~ViewInformation() = default;

  // `values` has a place for each sight and gets numbers of at least 0. A pure function of the
  // sight; thread-safe.
  virtual void contributions(std::span<const VoxelSight> sights, std::span<float> values) const = 0;
};

}  // namespace lapwing
