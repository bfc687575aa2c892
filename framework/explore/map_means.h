// SPDX-License-Identifier: Apache-2.0
// Means of a map at several scales, kept up to date while the map grows (thesis 5.4.3).
//
// Level l holds the mean occupancy and uncertainty of aligned cubes of (2^l)^3 voxels (reading
// 5.4), as Map::read_means gives them, to single precision: level 1 is read from the map, each
// further one is the mean of the one below. Only what changed is read again.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "framework/map/map.h"

namespace lapwing {

class MapMeans {
 public:
  static constexpr int kMostLevels = 6;

  // The map outlives this object; its voxels must be below 2^16 - 2^kMostLevels, and are.
  explicit MapMeans(const Map& map) : map_(&map) {}

  // What lies within this box of voxels may have changed. Not while anybody reads.
  void touch(const VoxelBox& box);

  // Brings the levels 1 to `levels` up to date; thread-safe, and free where nothing was touched.
  // InputError for fewer than 1 or more than kMostLevels.
  void refresh(int levels) const;

  // The cubes of a level from `low`, `size` of them along each axis, x fastest; cube c holds the
  // voxels from c 2^level on. Places that nothing is known of, also beyond the largest map, have
  // occupancy 0.5 and uncertainty 1. After `refresh`; thread-safe.
  void copy(int level, const int low[3], const int size[3], std::vector<MeanReading>& out) const;

  std::size_t bytes() const;

 private:
  static constexpr int kEdge = 8;  // cubes along an edge of a block
  struct Block {
    MeanReading cubes[kEdge * kEdge * kEdge];
  };
  struct Level {
    std::unordered_map<std::uint64_t, std::unique_ptr<Block>> blocks;
  };
  static std::uint64_t key_of(int x, int y, int z) {
    return static_cast<std::uint64_t>(x) | static_cast<std::uint64_t>(y) << 20 |
           static_cast<std::uint64_t>(z) << 40;
  }
  Block& block(int level, int x, int y, int z) const;
  const Block* find(int level, int x, int y, int z) const;
  void read_first(const VoxelBox& box) const;
  void halve(int level, const VoxelBox& box) const;

  const Map* map_;
  std::vector<VoxelBox> touched_;               // all of them, for levels made later
  mutable std::size_t done_[kMostLevels] = {};  // of `touched_`, by level
  mutable Level levels_[kMostLevels];
  mutable std::mutex mutex_;
};

}  // namespace lapwing
