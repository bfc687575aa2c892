// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/episode_replay.h"

#include "framework/core/error.h"
#include "framework/explore/episode_map.h"

namespace lapwing {
namespace {

constexpr int kBetweenKept = 8;  // images
constexpr std::size_t kMostLeaves = (std::size_t{192} << 20) / sizeof(VoxelLeaf);

}  // namespace

EpisodeReplay::EpisodeReplay(EpisodeWorld world) : world_(std::move(world)) {
  // Of the episode itself: they end with it.
  world_.settings.cancellation = nullptr;
  world_.settings.progress = nullptr;
}

void EpisodeReplay::took(const Viewpoint& view) {
  const std::lock_guard lock(mutex_);
  views_.push_back(view);
}

int EpisodeReplay::images() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(views_.size());
}

void EpisodeReplay::begin() {
  map_ = world_.new_map();
  map_->set_threads(world_.settings.threads);
  taken_ = 0;
}

void EpisodeReplay::forget() {
  map_.reset();
  kept_.clear();
  kept_leaves_ = 0;
  taken_ = 0;
}

void EpisodeReplay::take_next() {
  Viewpoint view;
  {
    const std::lock_guard lock(mutex_);
    view = views_.at(static_cast<std::size_t>(taken_));
  }
  const EpisodeSettings& s = world_.settings;
  PosedDepthImage image =
      s.sensor.measure(*world_.scene, view, s.seed + static_cast<std::uint64_t>(taken_), s.threads);
  s.sensor.smooth(image, s.threads);
  map_->integrate(image);
  clear_body(*map_, view, s.body);
  ++taken_;
}

// So that a step back, or a search, does not begin at the start.
void EpisodeReplay::keep_state() {
  if (taken_ % kBetweenKept != 0 || kept_.contains(taken_)) return;
  std::vector<VoxelLeaf> leaves;
  map_->for_each_leaf([&](const VoxelLeaf& leaf) { leaves.push_back(leaf); });
  if (kept_leaves_ + leaves.size() > kMostLeaves) return;
  kept_leaves_ += leaves.size();
  kept_.emplace(taken_, std::move(leaves));
}

const Map& EpisodeReplay::after(int images) {
  if (const int most = this->images(); images < 0 || images > most)
    throw InputError("image: there is no image " + std::to_string(images) +
                     "; expected 0 (before the first) to " + std::to_string(most));
  const auto behind = kept_.upper_bound(images);
  const int nearest = behind == kept_.begin() ? 0 : std::prev(behind)->first;
  if (!map_ || images < taken_ || nearest > taken_) {
    begin();
    if (nearest > 0) {
      map_->import(kept_.at(nearest));
      taken_ = nearest;
    } else {
      clear_box(*map_, cleared_box(map_->grid(), world_.start.position, world_.settings.clear));
    }
  }
  while (taken_ < images) {
    take_next();
    keep_state();
  }
  return *map_;
}

std::optional<int> EpisodeReplay::known_from(const VoxelKey& voxel, int images) {
  if (!after(images).read(voxel).known) return std::nullopt;
  int unknown = -1, known = images;
  while (known - unknown > 1) {
    const int middle = unknown + (known - unknown) / 2;
    (after(middle).read(voxel).known ? known : unknown) = middle;
  }
  return known;
}

}  // namespace lapwing
