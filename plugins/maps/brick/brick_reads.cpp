// SPDX-License-Identifier: Apache-2.0
#include "plugins/maps/brick/brick_reads.h"

#include <algorithm>
#include <cmath>

namespace lapwing::brick_map {
namespace {

bool has(std::uint64_t word, int place) {
  return word >> place & 1;
}

VoxelKey key_at(const VoxelKey& corner, int place, int shift) {
  return {static_cast<std::uint16_t>(corner.x + ((place & 3) << shift)),
          static_cast<std::uint16_t>(corner.y + ((place >> 2 & 3) << shift)),
          static_cast<std::uint16_t>(corner.z + ((place >> 4) << shift))};
}

}  // namespace

VoxelReading read_voxel(const BrickGrid& bricks, const MapSettings& settings, const VoxelKey& key) {
  VoxelReading reading;
  const int cell[3] = {key.x, key.y, key.z};
  const Block* block = bricks.find(cell);
  const int at = place(cell, kBrickLevel);
  if (!block || !has(block->known, at)) return reading;
  if (!block->has_brick(at)) {
    reading.log_odds = block->content[at].log_odds;
  } else {
    const DenseBrick& brick = *block->content[at].brick;
    const int chunk = place(cell, kChunkLevel), voxel = place(cell, 0);
    if (!has(brick.known[chunk], voxel)) return reading;
    if (brick.has_slot(chunk)) {
      const std::uint32_t slot = brick.content[chunk];
      reading.log_odds = bricks.values(slot)[voxel];
      if (const std::uint16_t* counts = bricks.observations(slot))
        reading.observations = counts[voxel];
    } else {
      reading.log_odds = brick.alike(chunk);
    }
  }
  reading.known = true;
  reading.state = settings.state(reading.log_odds);
  return reading;
}

namespace {

bool chunk_free(const SweptBox& box, const int corner[3], std::uint64_t free) {
  for (std::uint64_t left = ~free; left; left &= left - 1) {
    const int voxel = std::countr_zero(left);
    const int cell[3] = {corner[0] + (voxel & 3), corner[1] + (voxel >> 2 & 3),
                         corner[2] + (voxel >> 4)};
    if (box.meets(cell, 0)) return false;
  }
  return true;
}

// Goes through the 4^3 parts of an aligned cube that are within the box's bounds and not free.
template <class Part>
bool parts_free(const SweptBox& box, const int corner[3], int shift, std::uint64_t all_free,
                const Part& part_free) {
  int low[3], high[3];
  for (int i = 0; i < 3; ++i) {
    low[i] = std::max(0, (box.lower[i] - corner[i]) >> shift);
    high[i] = std::min(3, (box.upper[i] - corner[i]) >> shift);
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const int part = x | y << 2 | z << 4;
        if (has(all_free, part)) continue;
        const int cell[3] = {corner[0] + (x << shift), corner[1] + (y << shift),
                             corner[2] + (z << shift)};
        if (box.meets(cell, shift) && !part_free(part, cell)) return false;
      }
  return true;
}

bool block_free(const SweptBox& box, const int corner[3], const Block& block) {
  return parts_free(box, corner, kBrickLevel, block.all_free, [&](int at, const int brick_at[3]) {
    if (!block.has_brick(at)) {
      // All of it blocks, but the box may pass it between two voxels' middles: ask the voxels.
      const int shift = kChunkLevel;
      return parts_free(box, brick_at, shift, 0,
                        [&](int, const int chunk_at[3]) { return chunk_free(box, chunk_at, 0); });
    }
    const DenseBrick& brick = *block.content[at].brick;
    return parts_free(box, brick_at, kChunkLevel, brick.all_free,
                      [&](int chunk, const int chunk_at[3]) {
                        return chunk_free(box, chunk_at, brick.free[chunk]);
                      });
  });
}

}  // namespace

bool sweep_free(const BrickGrid& bricks, const SweptBox& box) {
  for (int z = box.lower[2] & ~63; z <= box.upper[2]; z += 64)
    for (int y = box.lower[1] & ~63; y <= box.upper[1]; y += 64)
      for (int x = box.lower[0] & ~63; x <= box.upper[0]; x += 64) {
        const int corner[3] = {x, y, z};
        const Block* block = bricks.find(corner);
        if (block && block->all_free == kAll) continue;
        if (!box.meets(corner, kBlockLevel)) continue;
        static const Block kUnknown;
        if (!block_free(box, corner, block ? *block : kUnknown)) return false;
      }
  return true;
}

void visit_leaves(const BrickGrid& bricks, const std::function<void(const VoxelLeaf&)>& visit) {
  for (const Block* block : bricks.blocks())
    for (std::uint64_t left = block->known; left; left &= left - 1) {
      const int at = std::countr_zero(left);
      const VoxelKey brick_key = key_at(block->corner, at, kBrickLevel);
      if (!block->has_brick(at)) {
        visit({brick_key, kBrickLevel, 0, block->content[at].log_odds});
        continue;
      }
      const DenseBrick& brick = *block->content[at].brick;
      for (int chunk = 0; chunk < 64; ++chunk) {
        const VoxelKey chunk_key = key_at(brick_key, chunk, kChunkLevel);
        if (brick.known[chunk] == 0) continue;
        if (!brick.has_slot(chunk)) {
          visit({chunk_key, kChunkLevel, 0, brick.alike(chunk)});
          continue;
        }
        const float* values = bricks.values(brick.content[chunk]);
        const std::uint16_t* counts = bricks.observations(brick.content[chunk]);
        for (std::uint64_t voxels = brick.known[chunk]; voxels; voxels &= voxels - 1) {
          const int voxel = std::countr_zero(voxels);
          const std::uint16_t count = counts ? counts[voxel] : 0;
          visit({key_at(chunk_key, voxel, 0), 0, count, values[voxel]});
        }
      }
    }
}

std::optional<VoxelBox> known_box(const BrickGrid& bricks) {
  std::optional<VoxelBox> box;
  const auto add = [&](const VoxelKey& low, int level) {
    const auto last = static_cast<std::uint16_t>((1 << level) - 1);
    const VoxelKey high{static_cast<std::uint16_t>(low.x + last),
                        static_cast<std::uint16_t>(low.y + last),
                        static_cast<std::uint16_t>(low.z + last)};
    if (!box) box = VoxelBox{low, high};
    box->lower = {std::min(box->lower.x, low.x), std::min(box->lower.y, low.y),
                  std::min(box->lower.z, low.z)};
    box->upper = {std::max(box->upper.x, high.x), std::max(box->upper.y, high.y),
                  std::max(box->upper.z, high.z)};
  };
  visit_leaves(bricks, [&](const VoxelLeaf& leaf) { add(leaf.key, leaf.level); });
  return box;
}

VoxelCounts count_voxels(const BrickGrid& bricks, const MapSettings& settings) {
  VoxelCounts counts;
  visit_leaves(bricks, [&](const VoxelLeaf& leaf) {
    const std::uint64_t voxels = std::uint64_t{1} << 3 * leaf.level;
    const VoxelState state = settings.state(leaf.log_odds);
    counts.known += voxels;
    if (state == VoxelState::free) counts.free += voxels;
    if (state == VoxelState::occupied) counts.occupied += voxels;
  });
  return counts;
}

namespace {

// Log odds take few values; each thread remembers the probabilities of the last ones.
double remembered_probability(float log_odds) {
  struct Entry {
    float log_odds = 0;
    double probability = 0.5;
  };
  thread_local Entry entries[256];
  const auto bits = std::bit_cast<std::uint32_t>(log_odds);
  Entry& entry = entries[(bits * 0x9e3779b1u) >> 24];
  if (entry.log_odds != log_odds) entry = {log_odds, probability_of(log_odds)};
  return entry.probability;
}

struct Sum {
  double occupancy = 0, uncertainty = 0;
  void add(const Sum& other) {
    occupancy += other.occupancy;
    uncertainty += other.uncertainty;
  }
};

class Means {
 public:
  Means(const BrickGrid& bricks, const MapSettings& settings)
      : bricks_(bricks), settings_(settings) {}

  // Over the voxels of a chunk among `mask`.
  Sum chunk(const DenseBrick& brick, int chunk, std::uint64_t mask) const {
    const std::uint64_t known = brick.known[chunk] & mask;
    const double count = std::popcount(mask);
    if (known == 0) return {0.5 * count, count};
    if (!brick.has_slot(chunk)) return {count * remembered_probability(brick.alike(chunk)), count};
    Sum sum{0.5 * (count - std::popcount(known)), count};
    const float* values = bricks_.values(brick.content[chunk]);
    const std::uint16_t* counts = bricks_.observations(brick.content[chunk]);
    for (std::uint64_t left = known; left; left &= left - 1) {
      const int voxel = std::countr_zero(left);
      sum.occupancy += remembered_probability(values[voxel]);
      if (counts) sum.uncertainty += std::exp(-settings_.information * counts[voxel]) - 1;
    }
    return sum;
  }

  Sum whole(const DenseBrick& brick) const {
    float occupancy = brick.occupancy.load(std::memory_order_relaxed);
    float uncertain = brick.uncertainty.load(std::memory_order_relaxed);
    if (std::isnan(occupancy) || std::isnan(uncertain)) {
      Sum sum;
      for (int k = 0; k < 64; ++k) sum.add(chunk(brick, k, kAll));
      occupancy = static_cast<float>(sum.occupancy / 4096);
      uncertain = static_cast<float>(sum.uncertainty / 4096);
      brick.occupancy.store(occupancy, std::memory_order_relaxed);
      brick.uncertainty.store(uncertain, std::memory_order_relaxed);
    }
    return {occupancy * 4096.0, uncertain * 4096.0};
  }

  // A cube of at most a brick, within one.
  Sum within_brick(int level, const int cell[3]) const {
    const double voxels = 1 << 3 * level;
    const Block* block = bricks_.find(cell);
    const int at = place(cell, kBrickLevel);
    if (!block || !has(block->known, at)) return {0.5 * voxels, voxels};
    if (!block->has_brick(at))
      return {voxels * remembered_probability(block->content[at].log_odds), voxels};
    const DenseBrick& brick = *block->content[at].brick;
    const int in_brick = place(cell, kChunkLevel), voxel = place(cell, 0);
    if (level == 4) return whole(brick);
    if (level == 2) return chunk(brick, in_brick, kAll);
    if (level < 2) return chunk(brick, in_brick, level == 1 ? eight(voxel) : bit(voxel));
    Sum sum;
    for (std::uint64_t left = eight(in_brick); left; left &= left - 1)
      sum.add(chunk(brick, std::countr_zero(left), kAll));
    return sum;
  }

 private:
  const BrickGrid& bricks_;
  const MapSettings& settings_;
};

}  // namespace

MeanReading mean_of_cube(const BrickGrid& bricks, const MapSettings& settings, int level,
                         const VoxelKey& key) {
  const Means means(bricks, settings);
  const int edge = 1 << level, step = std::min(edge, 1 << kBrickLevel);
  const int low[3] = {key.x & -edge, key.y & -edge, key.z & -edge};
  Sum sum;
  for (int z = low[2]; z < low[2] + edge; z += step)
    for (int y = low[1]; y < low[1] + edge; y += step)
      for (int x = low[0]; x < low[0] + edge; x += step) {
        const int cell[3] = {x, y, z};
        sum.add(means.within_brick(std::min(level, kBrickLevel), cell));
      }
  const double voxels = static_cast<double>(edge) * edge * edge;
  return {static_cast<float>(sum.occupancy / voxels), static_cast<float>(sum.uncertainty / voxels)};
}

}  // namespace lapwing::brick_map
