// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/map_means.h"

#include <algorithm>

#include "framework/core/error.h"

namespace lapwing {

void MapMeans::touch(const VoxelBox& box) {
  touched_.push_back(box);
}

MapMeans::Block& MapMeans::block(int level, int x, int y, int z) const {
  std::unique_ptr<Block>& made = levels_[level - 1].blocks[key_of(x, y, z)];
  if (!made) made = std::make_unique<Block>();
  return *made;
}

const MapMeans::Block* MapMeans::find(int level, int x, int y, int z) const {
  if (x < 0 || y < 0 || z < 0) return nullptr;
  const auto& blocks = levels_[level - 1].blocks;
  const auto found = blocks.find(key_of(x, y, z));
  return found == blocks.end() ? nullptr : found->second.get();
}

void MapMeans::refresh(int levels) const {
  if (levels < 1 || levels > kMostLevels)
    throw InputError("means at " + std::to_string(levels) + " levels; expected 1 to " +
                     std::to_string(kMostLevels));
  const std::lock_guard lock(mutex_);
  for (int level = 1; level <= levels; ++level) {
    std::size_t& done = done_[level - 1];
    for (; done < touched_.size(); ++done) {
      if (level == 1)
        read_first(touched_[done]);
      else
        halve(level, touched_[done]);
    }
  }
}

// Block by block, so that the map is asked for neighbours together.
void MapMeans::read_first(const VoxelBox& box) const {
  int low[3], high[3];
  for (int i = 0; i < 3; ++i) {
    low[i] = box.lower[i] >> 1;
    high[i] = box.upper[i] >> 1;
  }
  std::vector<VoxelKey> keys;
  std::vector<MeanReading> means;
  std::vector<int> places;
  for (int bz = low[2] / kEdge; bz <= high[2] / kEdge; ++bz)
    for (int by = low[1] / kEdge; by <= high[1] / kEdge; ++by)
      for (int bx = low[0] / kEdge; bx <= high[0] / kEdge; ++bx) {
        keys.clear();
        places.clear();
        const int at[3] = {bx * kEdge, by * kEdge, bz * kEdge};
        int from[3], to[3];
        for (int i = 0; i < 3; ++i) {
          from[i] = std::max(low[i], at[i]);
          to[i] = std::min(high[i], at[i] + kEdge - 1);
        }
        for (int z = from[2]; z <= to[2]; ++z)
          for (int y = from[1]; y <= to[1]; ++y)
            for (int x = from[0]; x <= to[0]; ++x) {
              keys.push_back({static_cast<std::uint16_t>(2 * x), static_cast<std::uint16_t>(2 * y),
                              static_cast<std::uint16_t>(2 * z)});
              places.push_back((x - at[0]) + kEdge * ((y - at[1]) + kEdge * (z - at[2])));
            }
        means.resize(keys.size());
        map_->read_means(1, keys, means);
        Block& cubes = block(1, bx, by, bz);
        for (std::size_t k = 0; k < keys.size(); ++k)
          cubes.cubes[static_cast<std::size_t>(places[k])] = means[k];
      }
}

void MapMeans::halve(int level, const VoxelBox& box) const {
  int low[3], high[3];
  for (int i = 0; i < 3; ++i) {
    low[i] = box.lower[i] >> level;
    high[i] = box.upper[i] >> level;
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        // The eight cubes below lie in one block.
        const Block* below = find(level - 1, 2 * x / kEdge, 2 * y / kEdge, 2 * z / kEdge);
        if (!below) continue;
        MeanReading mean{0, 0};
        const int corner = 2 * x % kEdge + kEdge * (2 * y % kEdge + kEdge * (2 * z % kEdge));
        for (int k = 0; k < 8; ++k) {
          const MeanReading& part =
              below->cubes[corner + (k & 1) + kEdge * (k >> 1 & 1) + kEdge * kEdge * (k >> 2)];
          mean.occupancy += part.occupancy;
          mean.uncertainty += part.uncertainty;
        }
        mean.occupancy /= 8;
        mean.uncertainty /= 8;
        Block& cubes = block(level, x / kEdge, y / kEdge, z / kEdge);
        cubes.cubes[x % kEdge + kEdge * (y % kEdge + kEdge * (z % kEdge))] = mean;
      }
}

void MapMeans::copy(int level, const int low[3], const int size[3],
                    std::vector<MeanReading>& out) const {
  const auto volume = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                      static_cast<std::size_t>(size[2]);
  out.assign(volume, MeanReading{});
  const auto floor_of = [](int cube) { return cube >= 0 ? cube / kEdge : -1; };
  for (int bz = floor_of(low[2]); bz <= floor_of(low[2] + size[2] - 1); ++bz)
    for (int by = floor_of(low[1]); by <= floor_of(low[1] + size[1] - 1); ++by)
      for (int bx = floor_of(low[0]); bx <= floor_of(low[0] + size[0] - 1); ++bx) {
        const Block* found = find(level, bx, by, bz);
        if (!found) continue;
        const int at[3] = {bx * kEdge, by * kEdge, bz * kEdge};
        int from[3], to[3];
        for (int i = 0; i < 3; ++i) {
          from[i] = std::max(low[i], at[i]);
          to[i] = std::min(low[i] + size[i], at[i] + kEdge);
        }
        for (int z = from[2]; z < to[2]; ++z)
          for (int y = from[1]; y < to[1]; ++y) {
            const MeanReading* source =
                found->cubes + (from[0] - at[0]) + kEdge * ((y - at[1]) + kEdge * (z - at[2]));
            MeanReading* target =
                out.data() + (from[0] - low[0]) + size[0] * ((y - low[1]) + size[1] * (z - low[2]));
            std::copy(source, source + (to[0] - from[0]), target);
          }
      }
}

std::size_t MapMeans::bytes() const {
  std::size_t sum = sizeof *this + touched_.size() * sizeof(VoxelBox);
  for (const Level& level : levels_) sum += level.blocks.size() * (sizeof(Block) + 48);
  return sum;
}

}  // namespace lapwing
