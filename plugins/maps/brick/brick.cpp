// SPDX-License-Identifier: Apache-2.0
// A map of dense bricks in a sparse grid: equal to OctoMap's, and fast. See README.md.
#include <algorithm>
#include <bit>

#include "framework/core/parallel.h"
#include "framework/map/map.h"
#include "framework/plugin/plugin.h"
#include "plugins/maps/brick/brick_grid.h"
#include "plugins/maps/brick/brick_reads.h"
#include "plugins/maps/brick/cast_lanes.h"
#include "plugins/maps/brick/scan_marks.h"
#include "plugins/maps/brick/voxel_update.h"

namespace lapwing {

using namespace brick_map;

namespace {

constexpr std::size_t kBricksAPart = 16;

class BrickMap : public Map {
 public:
  explicit BrickMap(const MapSettings& given)
      : Map(given), bricks_(settings()), marks_(settings()) {}

  VoxelReading read(const VoxelKey& key) const override {
    return read_voxel(bricks_, settings(), key);
  }
  void read_states(std::span<const VoxelKey> keys, std::span<VoxelState> states) const override {
    for (std::size_t k = 0; k < keys.size(); ++k)
      states[k] = read_voxel(bricks_, settings(), keys[k]).state;
  }
  void for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const override {
    visit_leaves(bricks_, visit);
  }
  std::optional<VoxelBox> bounds() const override { return known_box(bricks_); }
  VoxelCounts counts() const override { return count_voxels(bricks_, settings()); }
  std::size_t bytes() const override { return sizeof *this + bricks_.bytes() + marks_.bytes(); }

 protected:
  void cast_checked(std::span<const MapRay> rays, std::span<MapRayHit> hits) const override {
    cast_rays(bricks_, settings(), rays, hits);
  }

  bool sweep_checked(const SweptBox& box) const override { return sweep_free(bricks_, box); }

  void means_checked(int level, std::span<const VoxelKey> keys,
                     std::span<MeanReading> means) const override {
    for (std::size_t k = 0; k < keys.size(); ++k)
      means[k] = mean_of_cube(bricks_, settings(), level, keys[k]);
  }

  void insert(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W) override;
  void assign(std::span<const VoxelLeaf> leaves) override;

 private:
  // A brick that the scan changes, and which of its chunks.
  struct Change {
    Block* block;
    DenseBrick* brick;
    ScanMarks::Corner corner;
    std::uint64_t chunks;
  };

  bool alike_after(float log_odds, const BrickMarks& marks, int chunk) const;
  std::uint64_t changed_chunks(const BrickMarks& marks, std::size_t& bricks,
                               std::size_t& slots) const;
  void prepare(Change& change);
  void update(const Change& change);
  void set_leaf(const VoxelLeaf& leaf);
  void set_voxels(const VoxelLeaf& leaf);
  std::size_t bytes_for(std::span<const VoxelLeaf> leaves) const;

  BrickGrid bricks_;
  ScanMarks marks_;
  std::vector<Change> changes_;
};

// Whether a chunk that is alike throughout stays so, and as it is: at a clamp.
bool BrickMap::alike_after(float log_odds, const BrickMarks& marks, int chunk) const {
  if (settings().observations) return false;
  if (marks.hit[chunk] == 0) return log_odds <= settings().clamp_min;
  return marks.hit[chunk] == marks.measured[chunk] && log_odds >= settings().clamp_max;
}

// The chunks that need their values, and how many bricks and slots that takes at most.
std::uint64_t BrickMap::changed_chunks(const BrickMarks& marks, std::size_t& bricks,
                                       std::size_t& slots) const {
  const Block* block = bricks_.find(marks.cell);
  const int at = place(marks.cell, kBrickLevel);
  const DenseBrick* brick = block && block->has_brick(at) ? block->content[at].brick : nullptr;
  const bool alike = block && !brick && (block->known & bit(at));
  std::uint64_t changed = 0;
  for (std::uint64_t left = marks.chunks; left; left &= left - 1) {
    const int chunk = std::countr_zero(left);
    if (alike && alike_after(block->content[at].log_odds, marks, chunk)) continue;
    if (brick && brick->has_slot(chunk)) {
      changed |= bit(chunk);
      continue;
    }
    if (brick && brick->known[chunk] && alike_after(brick->alike(chunk), marks, chunk)) continue;
    changed |= bit(chunk);
    ++slots;
  }
  bricks += changed != 0 && !brick;
  return changed;
}

void BrickMap::prepare(Change& change) {
  change.block = &bricks_.make_block(change.corner.cell);
  change.brick = &bricks_.make_brick(*change.block, place(change.corner.cell, kBrickLevel));
  for (std::uint64_t left = change.chunks; left; left &= left - 1)
    bricks_.make_slot(*change.brick, std::countr_zero(left));
}

void BrickMap::update(const Change& change) {
  const BrickMarks marks = marks_.take(change.corner, true);
  if (!change.brick) return;
  DenseBrick& brick = *change.brick;
  for (std::uint64_t left = change.chunks; left; left &= left - 1) {
    const int chunk = std::countr_zero(left);
    const std::uint64_t measured = marks.measured[chunk];
    const std::uint32_t slot = brick.content[chunk];
    const std::uint64_t free =
        update_voxels(bricks_.values(slot), measured, marks.hit[chunk], settings());
    brick.known[chunk] |= measured;
    brick.free[chunk] = (brick.free[chunk] & ~measured) | free;
    std::uint16_t* observations = bricks_.observations(slot);
    if (!observations) continue;
    for (std::uint64_t voxels = measured; voxels; voxels &= voxels - 1) {
      std::uint16_t& count = observations[std::countr_zero(voxels)];
      if (count < 65535) ++count;
    }
  }
}

void BrickMap::insert(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W) {
  changes_.clear();
  std::size_t bricks = 0, slots = 0;
  for (const ScanMarks::Corner& corner : marks_.mark(points_W, origin_W, threads()))
    changes_.push_back(
        {nullptr, nullptr, corner, changed_chunks(marks_.take(corner, false), bricks, slots)});
  slots -= std::min(slots, bricks_.spare_slots());
  const std::size_t more = BrickGrid::bytes_of(bricks / 8, bricks, slots, settings().observations);
  const bool fits = bytes() + more <= settings().memory_limit;
  for (Change& change : changes_)
    if (change.chunks && fits) prepare(change);
  const std::size_t parts = (changes_.size() + kBricksAPart - 1) / kBricksAPart;
  parallel_for(parts, threads(), [&](std::size_t part) {
    const std::size_t end = std::min(changes_.size(), (part + 1) * kBricksAPart);
    for (std::size_t k = part * kBricksAPart; k < end; ++k) update(changes_[k]);
  });
  if (!fits) {
    marks_.finish();
    require_memory(bytes() + more);
  }
  for (const Change& change : changes_)
    if (change.chunks)
      bricks_.tidy(*change.block, place(change.corner.cell, kBrickLevel), change.chunks);
  marks_.finish();
}

// What the leaves take at most, beyond what there is.
std::size_t BrickMap::bytes_for(std::span<const VoxelLeaf> leaves) const {
  std::vector<std::uint64_t> parts[3];  // chunks, bricks, blocks that are entered
  std::size_t blocks = 0, slots = 0;
  for (const VoxelLeaf& leaf : leaves) {
    const std::uint64_t morton = leaf.key.morton();
    if (leaf.level < kChunkLevel) parts[0].push_back(morton >> 3 * kChunkLevel);
    if (leaf.level < kBrickLevel) parts[1].push_back(morton >> 3 * kBrickLevel);
    if (leaf.level < kBlockLevel)
      parts[2].push_back(morton >> 3 * kBlockLevel);
    else
      blocks += std::size_t{1} << 3 * (leaf.level - kBlockLevel);
    if (settings().observations && leaf.level >= kChunkLevel)
      slots += std::size_t{1} << 3 * (leaf.level - kChunkLevel);
  }
  for (auto& part : parts) {
    std::sort(part.begin(), part.end());
    part.erase(std::unique(part.begin(), part.end()), part.end());
  }
  const std::size_t bricks = parts[1].size() + (slots >> 6) + (settings().observations ? 1 : 0);
  return BrickGrid::bytes_of(blocks + parts[2].size(), bricks, slots + parts[0].size(),
                             settings().observations);
}

void BrickMap::assign(std::span<const VoxelLeaf> leaves) {
  require_memory(bytes() + bytes_for(leaves));
  for (const VoxelLeaf& leaf : leaves) set_leaf(leaf);
}

void BrickMap::set_leaf(const VoxelLeaf& leaf) {
  const int whole = settings().observations ? 0 : leaf.level;  // counted voxels stand alone
  const int part = whole >= kBrickLevel ? kBrickLevel : whole >= kChunkLevel ? kChunkLevel : -1;
  if (part < 0 && leaf.level <= kChunkLevel) return set_voxels(leaf);
  const int edge = part < 0 ? kChunkLevel : part;
  const int last = (1 << leaf.level) - 1, step = 1 << edge;
  for (int z = leaf.key.z; z <= leaf.key.z + last; z += step)
    for (int y = leaf.key.y; y <= leaf.key.y + last; y += step)
      for (int x = leaf.key.x; x <= leaf.key.x + last; x += step) {
        const int cell[3] = {x, y, z};
        if (part < 0) {
          VoxelLeaf chunk = leaf;
          chunk.level = kChunkLevel;
          chunk.key = {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                       static_cast<std::uint16_t>(z)};
          set_voxels(chunk);
          continue;
        }
        Block& block = bricks_.make_block(cell);
        const int at = place(cell, kBrickLevel);
        if (part == kBrickLevel) {
          if (block.has_brick(at)) {
            for (std::uint64_t left = block.content[at].brick->slotted; left; left &= left - 1)
              bricks_.drop_slot(*block.content[at].brick, std::countr_zero(left));
            bricks_.drop_brick(block, at);
          }
          bricks_.set_brick(block, at, leaf.log_odds);
          continue;
        }
        DenseBrick& brick = bricks_.make_brick(block, at);
        const int chunk = place(cell, kChunkLevel);
        if (brick.has_slot(chunk)) bricks_.drop_slot(brick, chunk);
        bricks_.set_chunk(brick, chunk, leaf.log_odds);
        bricks_.tidy(block, at, bit(chunk));
      }
}

// A cube of at most a chunk.
void BrickMap::set_voxels(const VoxelLeaf& leaf) {
  const int cell[3] = {leaf.key.x, leaf.key.y, leaf.key.z};
  Block& block = bricks_.make_block(cell);
  const int at = place(cell, kBrickLevel), chunk = place(cell, kChunkLevel);
  DenseBrick& brick = bricks_.make_brick(block, at);
  const std::uint32_t slot = bricks_.make_slot(brick, chunk);
  const std::uint64_t cube = leaf.level == 0   ? bit(place(cell, 0))
                             : leaf.level == 1 ? eight(place(cell, 0))
                                               : kAll;
  for (std::uint64_t left = cube; left; left &= left - 1) {
    const int voxel = std::countr_zero(left);
    bricks_.values(slot)[voxel] = leaf.log_odds;
    if (settings().observations) bricks_.observations(slot)[voxel] = leaf.observations;
  }
  brick.known[chunk] |= cube;
  brick.free[chunk] &= ~cube;
  if (settings().state(leaf.log_odds) == VoxelState::free) brick.free[chunk] |= cube;
  bricks_.tidy(block, at, bit(chunk));
}

class Brick final : public BrickMap {
 public:
  static constexpr PluginText kText{"brick", "1.0.0",
                                    "sparse grid of dense bricks: equal to octomap, faster",
                                    "thesis 2.2, 5.4.1, 5.4.3"};
  static ParameterTable parameters() { return map_parameters(); }
  explicit Brick(const Parameters& parameters) : BrickMap(map_settings(parameters)) {}
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Brick)
