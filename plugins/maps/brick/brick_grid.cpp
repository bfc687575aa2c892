// SPDX-License-Identifier: Apache-2.0
#include "plugins/maps/brick/brick_grid.h"

#include <algorithm>
#include <new>

namespace lapwing::brick_map {

void BrickGrid::grow_table() {
  std::vector<Entry> old(std::max<std::size_t>(64, 2 * table_.size()));
  old.swap(table_);
  shift_ = 64 - std::countr_zero(table_.size());
  for (const Entry& entry : old) {
    if (!entry.block) continue;
    std::size_t at = hash(entry.key);
    while (table_[at].block) at = (at + 1) & (table_.size() - 1);
    table_[at] = entry;
  }
}

Block& BrickGrid::make_block(const int cell[3]) {
  if (const Block* found = find(cell)) return const_cast<Block&>(*found);
  if (2 * (blocks_.size() + 1) > table_.size()) grow_table();
  auto made = std::make_unique<Block>();
  made->corner = {static_cast<std::uint16_t>(cell[0] & ~63),
                  static_cast<std::uint16_t>(cell[1] & ~63),
                  static_cast<std::uint16_t>(cell[2] & ~63)};
  const std::uint32_t key = block_key(cell);
  std::size_t at = hash(key);
  while (table_[at].block) at = (at + 1) & (table_.size() - 1);
  table_[at] = {key, made.get()};
  blocks_.push_back(std::move(made));
  Block& block = *blocks_.back();
  for (int i = 0; i < 3; ++i)
    for (const int side : {0, 1}) {
      int beyond[3] = {cell[0], cell[1], cell[2]};
      beyond[i] += side ? 64 : -64;
      if (beyond[i] < 0 || beyond[i] >= kKeyCount) continue;
      Block* neighbour = const_cast<Block*>(find(beyond));
      block.next[side][i] = neighbour;
      if (neighbour) neighbour->next[1 - side][i] = &block;
    }
  return block;
}

DenseBrick& BrickGrid::make_brick(Block& block, int place) {
  if (block.has_brick(place)) return *block.content[place].brick;
  if (spare_bricks_.empty()) {
    bricks_.push_back(std::make_unique<BrickPage>());
    for (std::uint32_t k = kBricksAPage; k-- > 0;)
      spare_bricks_.push_back(&bricks_.back()->bricks[k]);
  }
  DenseBrick* brick = spare_bricks_.back();
  spare_bricks_.pop_back();
  brick->~DenseBrick();
  new (brick) DenseBrick();
  if (block.known & bit(place)) {
    for (int chunk = 0; chunk < 64; ++chunk)
      set_chunk(*brick, chunk, block.content[place].log_odds);
  }
  block.known |= bit(place);
  block.bricked |= bit(place);
  block.content[place].brick = brick;
  return *brick;
}

std::uint32_t BrickGrid::make_slot(DenseBrick& brick, int chunk) {
  if (brick.has_slot(chunk)) return brick.content[chunk];
  if (spare_slots_.empty()) {
    const auto first = static_cast<std::uint32_t>(slots_.size() * kSlotsAPage);
    slots_.push_back(std::make_unique<SlotPage>());
    if (settings_.observations) counts_.push_back(std::make_unique<CountPage>());
    for (std::uint32_t k = kSlotsAPage; k-- > 0;) spare_slots_.push_back(first + k);
  }
  const std::uint32_t slot = spare_slots_.back();
  spare_slots_.pop_back();
  std::fill_n(values(slot), 64, brick.known[chunk] ? brick.alike(chunk) : 0.0f);
  if (settings_.observations) std::fill_n(observations(slot), 64, std::uint16_t{0});
  brick.content[chunk] = slot;
  brick.slotted |= bit(chunk);
  return slot;
}

void BrickGrid::drop_slot(DenseBrick& brick, int chunk) {
  spare_slots_.push_back(brick.content[chunk]);
  brick.slotted &= ~bit(chunk);
}

void BrickGrid::drop_brick(Block& block, int place) {
  spare_bricks_.push_back(block.content[place].brick);
  block.bricked &= ~bit(place);
}

void BrickGrid::set_chunk(DenseBrick& brick, int chunk, float log_odds) {
  const bool is_free = settings_.state(log_odds) == VoxelState::free;
  brick.known[chunk] = kAll;
  brick.free[chunk] = is_free ? kAll : 0;
  brick.all_free = is_free ? brick.all_free | bit(chunk) : brick.all_free & ~bit(chunk);
  brick.content[chunk] = std::bit_cast<std::uint32_t>(log_odds);
}

void BrickGrid::set_brick(Block& block, int place, float log_odds) {
  const bool is_free = settings_.state(log_odds) == VoxelState::free;
  block.known |= bit(place);
  block.all_free = is_free ? block.all_free | bit(place) : block.all_free & ~bit(place);
  block.content[place].log_odds = log_odds;
}

void BrickGrid::tidy(Block& block, int place, std::uint64_t chunks) {
  DenseBrick& brick = *block.content[place].brick;
  brick.forget_means();
  for (; chunks; chunks &= chunks - 1) {
    const int chunk = std::countr_zero(chunks);
    brick.all_free =
        brick.free[chunk] == kAll ? brick.all_free | bit(chunk) : brick.all_free & ~bit(chunk);
    if (settings_.observations || brick.known[chunk] != kAll || !brick.has_slot(chunk)) continue;
    const float* of = values(brick.content[chunk]);
    const float first = of[0];
    if (of[63] != first || !std::all_of(of, of + 64, [&](float v) { return v == first; })) continue;
    drop_slot(brick, chunk);
    brick.content[chunk] = std::bit_cast<std::uint32_t>(first);
  }
  block.all_free =
      brick.all_free == kAll ? block.all_free | bit(place) : block.all_free & ~bit(place);
  if (brick.slotted != 0 || settings_.observations) return;
  for (int chunk = 0; chunk < 64; ++chunk)
    if (brick.known[chunk] != kAll || brick.content[chunk] != brick.content[0]) return;
  const float log_odds = brick.alike(0);
  drop_brick(block, place);
  set_brick(block, place, log_odds);
}

std::vector<const Block*> BrickGrid::blocks() const {
  std::vector<const Block*> result;
  for (const auto& block : blocks_) result.push_back(block.get());
  std::sort(result.begin(), result.end(),
            [](const Block* a, const Block* b) { return a->corner.morton() < b->corner.morton(); });
  return result;
}

std::size_t BrickGrid::bytes() const {
  return table_.capacity() * sizeof(Entry) + blocks_.size() * (sizeof(Block) + 16) +
         bricks_.size() * sizeof(BrickPage) + slots_.size() * sizeof(SlotPage) +
         counts_.size() * sizeof(CountPage) + spare_slots_.capacity() * sizeof(std::uint32_t) +
         spare_bricks_.capacity() * sizeof(DenseBrick*);
}

std::size_t BrickGrid::bytes_of(std::size_t blocks, std::size_t bricks, std::size_t slots,
                                bool observations) {
  return blocks * (sizeof(Block) + 16 + 4 * sizeof(Entry)) + bricks * sizeof(DenseBrick) +
         slots * (sizeof(float) + (observations ? sizeof(std::uint16_t) : 0)) * 64;
}

}  // namespace lapwing::brick_map
