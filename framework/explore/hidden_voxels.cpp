// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/hidden_voxels.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/map/ray_walk.h"
#include "framework/map/scan.h"

namespace lapwing {

void HiddenVoxels::follow(double farthest) const {
  if (!(farthest > 0 && std::isfinite(farthest)))
    throw InputError("a distance behind surfaces must be above 0 and finite, not " +
                     plain_number(farthest));
  const std::lock_guard lock(mutex_);
  if (farthest <= farthest_) return;
  if (seen_)
    throw InputError(
        "voxels up to " + plain_number(farthest) +
        " m behind surfaces are requested after the first image, and only those up to " +
        plain_number(farthest_) + " m were followed");
  farthest_ = farthest;
}

void HiddenVoxels::require_followed(double farthest) const {
  const std::lock_guard lock(mutex_);
  if (farthest > farthest_)
    throw InputError(
        "voxels up to " + plain_number(farthest) +
        " m behind surfaces were not followed; require_fit of a utility must state before "
        "the first image that it needs them");
}

void HiddenVoxels::saw(const PosedDepthImage& measured) {
  points_.clear();
  if (farthest_ > 0) {
    const MapSettings& settings = map_->settings();
    scan_points(measured, settings.pixel_step, settings.maximum_range, settings.resolution,
                points_);
  }
  saw(points_, measured.camera.position);
}

void HiddenVoxels::saw(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3d& origin_W) {
  seen_ = true;
  if (!(farthest_ > 0)) return;
  std::uint64_t at = ~std::uint64_t{0};
  Block* block = nullptr;
  for (const Eigen::Vector3f& point : points_W) {
    const Eigen::Vector3d surface = point.cast<double>(), ray = surface - origin_W;
    const double depth = ray.norm();
    if (!(depth > 0 && depth <= map_->settings().maximum_range) || !map_->grid().contains(surface))
      continue;
    RayWalk walk(map_->grid(), surface, ray / depth);
    for (walk.advance(); walk.inside() && walk.entered < farthest_; walk.advance()) {
      const VoxelKey key = walk.key();
      if (const std::uint64_t wanted = block_key(key); wanted != at) {
        at = wanted;
        std::unique_ptr<Block>& made = blocks_[wanted];
        if (!made) {
          made = std::make_unique<Block>();
          made->fill(kNowhere);
        }
        block = made.get();
      }
      float& nearest = (*block)[place_of(key)];
      nearest = std::min(nearest, static_cast<float>(walk.entered));
    }
  }
}

std::size_t HiddenVoxels::bytes() const {
  return sizeof *this + blocks_.size() * (sizeof(Block) + 48) +
         points_.capacity() * sizeof(Eigen::Vector3f);
}

}  // namespace lapwing
