// SPDX-License-Identifier: Apache-2.0
// The map of an episode after any of its images, for viewers: its images are taken again. An
// episode is deterministic, so that each voxel has the very numbers that the explorer knew.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "framework/explore/episode.h"

namespace lapwing {

// What the maps of an episode come from, beside its views.
struct EpisodeWorld {
  EpisodeSettings settings;
  Viewpoint start;
  std::shared_ptr<const MeshScene> scene;
  std::function<std::unique_ptr<Map>()> new_map;
};

class EpisodeReplay {
 public:
  explicit EpisodeReplay(EpisodeWorld world);

  // The next view of the episode. `took` and `images` may be called while others are answered.
  void took(const Viewpoint& view);
  int images() const;

  // The map after so many images; after 0 it is what was taken to be free at the start. It holds
  // until the next call. Forward it is as quick as the images are; backward, and a jump, begin at
  // one of the states that are kept. InputError where there are fewer images, with how many.
  const Map& after(int images);
  // After how many images the voxel was known first, up to so many; 0: at the start. Nothing where
  // it is not. (What is known stays known.)
  std::optional<int> known_from(const VoxelKey& voxel, int images);
  // Drops the map and all states that are kept: the next question begins at the start.
  void forget();

 private:
  void begin();
  void take_next();
  void keep_state();

  EpisodeWorld world_;
  mutable std::mutex mutex_;
  std::vector<Viewpoint> views_;
  std::unique_ptr<Map> map_;
  int taken_ = 0;  // images in it
  std::map<int, std::vector<VoxelLeaf>> kept_;
  std::size_t kept_leaves_ = 0;
};

}  // namespace lapwing
