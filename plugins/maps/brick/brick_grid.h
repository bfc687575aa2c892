// SPDX-License-Identifier: Apache-2.0
// The sparse grid of the brick map: 4^3 voxels are a chunk, 4^3 chunks a brick, 4^3 bricks a block,
// and blocks stand in a hash table. On every level one word of 64 bits says which of the 64 parts
// are known, and which are free throughout. What is alike throughout holds one value.
//
// The place of a part in its word counts x fastest, then y, then z.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "framework/map/map_settings.h"

namespace lapwing::brick_map {

inline constexpr int kChunkLevel = 2, kBrickLevel = 4, kBlockLevel = 6;
inline constexpr std::uint64_t kAll = ~std::uint64_t{0};

// Place of a voxel in its chunk (shift 0), of a chunk in its brick (2), of a brick in its block
// (4).
inline int place(const int cell[3], int shift) {
  return (cell[0] >> shift & 3) | (cell[1] >> shift & 3) << 2 | (cell[2] >> shift & 3) << 4;
}
inline int place(const VoxelKey& key, int shift) {
  const int cell[3] = {key.x, key.y, key.z};
  return place(cell, shift);
}
inline std::uint64_t bit(int place) {
  return std::uint64_t{1} << place;
}
// The 2^3 parts around a place that form an aligned cube.
inline std::uint64_t eight(int place) {
  return std::uint64_t{0x330033} << (place & 0b101010);
}

// 16^3 voxels. A chunk without a slot is alike throughout: unknown, or of one log odds.
struct DenseBrick {
  std::uint64_t slotted = 0;   // chunks that hold a value for each voxel
  std::uint64_t all_free = 0;  // chunks
  // Mean occupancy and uncertainty, NaN until somebody asks; any thread may fill them in.
  mutable std::atomic<float> occupancy, uncertainty;
  std::uint64_t known[64] = {}, free[64] = {};  // voxels, by chunk
  std::uint32_t content[64] = {};               // the chunk's slot, or the bits of its log odds

  DenseBrick() { forget_means(); }
  void forget_means() {
    occupancy.store(std::numeric_limits<float>::quiet_NaN(), std::memory_order_relaxed);
    uncertainty.store(std::numeric_limits<float>::quiet_NaN(), std::memory_order_relaxed);
  }
  bool has_slot(int chunk) const { return slotted >> chunk & 1; }
  float alike(int chunk) const { return std::bit_cast<float>(content[chunk]); }
};

// 64^3 voxels. A brick that is known without a DenseBrick is alike throughout.
struct Block {
  std::uint64_t known = 0, all_free = 0;  // bricks; known: in part at least
  std::uint64_t bricked = 0;              // bricks that hold a DenseBrick
  union Content {
    DenseBrick* brick;
    float log_odds;
  } content[64] = {};
  const Block* next[2][3] = {};  // blocks at its faces, towards lower and higher keys
  VoxelKey corner;

  bool has_brick(int place) const { return bricked >> place & 1; }
};

class BrickGrid {
 public:
  explicit BrickGrid(const MapSettings& settings) : settings_(settings) {}

  const Block* find(const int cell[3]) const {
    if (table_.empty()) return nullptr;
    const std::uint32_t key = block_key(cell);
    for (std::size_t at = hash(key);; at = (at + 1) & (table_.size() - 1)) {
      if (table_[at].block == nullptr) return nullptr;
      if (table_[at].key == key) return table_[at].block;
    }
  }
  Block& make_block(const int cell[3]);
  // Splits what is alike.
  DenseBrick& make_brick(Block& block, int place);
  // The chunk's values, made where it has none.
  std::uint32_t make_slot(DenseBrick& brick, int chunk);
  void drop_slot(DenseBrick& brick, int chunk);
  void drop_brick(Block& block, int place);

  float* values(std::uint32_t slot) {
    return slots_[slot / kSlotsAPage]->values[slot % kSlotsAPage];
  }
  const float* values(std::uint32_t slot) const {
    return slots_[slot / kSlotsAPage]->values[slot % kSlotsAPage];
  }
  // Null unless observations are counted.
  std::uint16_t* observations(std::uint32_t slot) {
    return settings_.observations ? counts_[slot / kSlotsAPage]->counts[slot % kSlotsAPage]
                                  : nullptr;
  }
  const std::uint16_t* observations(std::uint32_t slot) const {
    return const_cast<BrickGrid*>(this)->observations(slot);
  }

  // What a chunk is alike throughout with is kept as one value, a brick likewise; summaries are
  // brought up to date. Maps that count observations keep their slots.
  void tidy(Block& block, int place, std::uint64_t chunks);
  void set_chunk(DenseBrick& brick, int chunk, float log_odds);  // alike throughout, no slot before
  void set_brick(Block& block, int place,
                 float log_odds);  // alike throughout, no DenseBrick before

  // In the order of their keys.
  std::vector<const Block*> blocks() const;
  std::size_t bytes() const;
  static std::size_t bytes_of(std::size_t blocks, std::size_t bricks, std::size_t slots,
                              bool observations);
  std::size_t spare_slots() const { return spare_slots_.size(); }

 private:
  static constexpr std::uint32_t kSlotsAPage = 256, kBricksAPage = 32;
  struct Entry {
    std::uint32_t key = 0;
    Block* block = nullptr;
  };
  struct SlotPage {
    float values[kSlotsAPage][64];
  };
  struct CountPage {
    std::uint16_t counts[kSlotsAPage][64];
  };
  struct BrickPage {
    DenseBrick bricks[kBricksAPage];
  };

  static std::uint32_t block_key(const int cell[3]) {
    return static_cast<std::uint32_t>(cell[0] >> 6 | (cell[1] >> 6) << 10 | (cell[2] >> 6) << 20);
  }
  std::size_t hash(std::uint32_t key) const { return (key * 0x9e3779b97f4a7c15ull) >> shift_; }
  void grow_table();

  MapSettings settings_;
  std::vector<Entry> table_;
  int shift_ = 64;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<std::unique_ptr<BrickPage>> bricks_;
  std::vector<std::unique_ptr<SlotPage>> slots_;
  std::vector<std::unique_ptr<CountPage>> counts_;
  std::vector<DenseBrick*> spare_bricks_;
  std::vector<std::uint32_t> spare_slots_;
};

}  // namespace lapwing::brick_map
