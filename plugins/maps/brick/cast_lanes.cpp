// SPDX-License-Identifier: Apache-2.0
// How: a caster keeps two groups of four rays. While one waits for memory, the other computes. Each
// turn, a group
//   1. looks at the cell of each ray: the largest free box ahead of it (bits of block, brick and
//      chunk, see ray_quad.h), or an end;
//   2. leaves that box: all four rays step to the far side of their boxes at once.
// Rays in one cell share one look. A full tile of 64 rays from one place first finds how far all of
// its rays are free (ray_beam.h) and starts there.
#include "plugins/maps/brick/cast_lanes.h"

#include "plugins/maps/brick/ray_beam.h"

namespace lapwing::brick_map {
namespace {

// Where a ray is among the bricks.
struct Place {
  const Block* block = nullptr;
  std::int32_t key = -1;  // of the block, of mirrored cells
};

// Instead of the edges of a free box: the cell is not free itself.
constexpr int kBlocked = -1;

// Four rays before they start.
struct Waiting {
  Quad quad;
  std::size_t ray[4];
  int count = 4;            // the others are copies
  bool known_free = false;  // where they begin
};

// What goes on with four rays beside their numbers.
struct Group {
  Waiting* rays = nullptr;  // none: idle
  bool under_way = false;   // else nobody has looked at where they begin
  unsigned alive = 0;       // rays that have not ended, as bits
  Four range;               // m
  Place place[4];
  FourInt edges;  // of the free boxes around their cells
};

class Caster {
 public:
  Caster(const BrickGrid& bricks, const MapSettings& settings, std::span<const MapRay> rays,
         std::span<MapRayHit> hits)
      : bricks_(bricks),
        settings_(settings),
        grid_(settings.resolution),
        rays_(rays),
        hits_(hits) {}

  __attribute__((always_inline)) void run() {
    for (;;) {
      bool busy = false;
      for (Group& group : groups_) {
        if (!group.rays) start(group);
        busy |= group.rays != nullptr;
      }
      if (!busy) return;
#pragma GCC unroll 1
      for (Group& group : groups_)
        if (group.rays && group.under_way) group.rays->quad.leave_boxes(group.edges);
#pragma GCC unroll 1
      for (Group& group : groups_)
        if (group.rays) visit(group);
    }
  }

 private:
  // More than one group of four hides how long each waits for its numbers.
  static constexpr int kGroups = 2;
  static constexpr std::size_t kBatch = RayBeam::kRays;

  struct Batch {
    Waiting waiting[kBatch / 4];
    int count = 0;
  };

  // The next four rays; none when all are under way, or for as long as other groups need what the
  // next batch would take.
  __attribute__((always_inline)) void start(Group& group) {
    while (started_ == batches_[current_].count)
      if (!next_batch()) return;
    Waiting& rays = batches_[current_].waiting[started_++];
    group.rays = &rays;
    group.under_way = rays.known_free;
    group.alive = (1u << rays.count) - 1;
    group.range = Four{rays_[rays.ray[0]].range, rays_[rays.ray[1]].range, rays_[rays.ray[2]].range,
                       rays_[rays.ray[3]].range};
    for (Place& place : group.place) place = {};
    group.edges = FourInt{};
  }

  __attribute__((always_inline)) bool next_batch() {
    if (next_ == rays_.size()) return false;
    Batch& batch = batches_[1 - current_];
    for (const Group& group : groups_)
      if (group.rays && batch.waiting <= group.rays && group.rays < batch.waiting + kBatch / 4)
        return false;
    current_ = 1 - current_;
    started_ = batch.count = 0;
    const std::size_t first = next_;
    next_ = std::min(rays_.size(), first + kBatch);
    if (next_ - first == kBatch && beam_.take(rays_.subspan(first, kBatch)))
      prepare_beam(batch, first);
    else
      for (std::size_t k = first; k < next_; k += 4) prepare(batch.waiting[batch.count++], k);
    return true;
  }

  __attribute__((always_inline)) void prepare_beam(Batch& batch, std::size_t first) {
    AxisStart<double, int> start[3];
    for (int i = 0; i < 3; ++i) {
      const double origin = beam_.origin()[i];
      const int cell = grid_.index(origin);
      start[i] = {cell, grid_.face(cell) - origin, grid_.face(cell + 1) - origin};
    }
    const std::array<double, RayBeam::kParts> free = beam_.free(bricks_, grid_);
    for (int k = 0; k < RayBeam::kRays / 4; ++k) {
      Waiting& rays = batch.waiting[k];
      for (std::size_t r = 0; r < 4; ++r)
        rays.ray[r] = first + static_cast<std::size_t>(RayBeam::first_of(k)) +
                      (r >> 1) * RayBeam::kEdge + (r & 1);
      rays.count = 4;
      const double from = free[static_cast<std::size_t>(k / RayBeam::kQuadsAPart)];
      rays.known_free = from > 0;
      rays.quad.prepare(grid_, start, beam_.directions(k));
      if (rays.known_free) rays.quad.go_to(from);
    }
    batch.count = RayBeam::kRays / 4;
  }

  // Any four rays, or fewer at the end.
  __attribute__((always_inline)) void prepare(Waiting& rays, std::size_t first) const {
    rays.count = static_cast<int>(std::min<std::size_t>(4, next_ - first));
    rays.known_free = false;
    AxisStart<Four, FourInt> start[3];
    Four direction[3];
    for (int k = 0; k < 4; ++k) {
      rays.ray[k] = std::min(first + static_cast<std::size_t>(k), next_ - 1);
      const MapRay& ray = rays_[rays.ray[k]];
      for (int i = 0; i < 3; ++i) {
        const int cell = grid_.index(ray.origin[i]);
        start[i].cell[k] = cell;
        start[i].to_lower[k] = grid_.face(cell) - ray.origin[i];
        start[i].to_higher[k] = grid_.face(cell + 1) - ray.origin[i];
        direction[i][k] = ray.direction[i];
      }
    }
    rays.quad.prepare(grid_, start, direction);
  }

  __attribute__((always_inline)) void visit(Group& group) {
    group.under_way = true;
    const Quad& quad = group.rays->quad;
    const FourLong far = quad.entered >= group.range;
    if (group.alive == 15 && quad.together() && none(far)) {
      VoxelState state;
      const int edges = look(group.place[0], quad, 0, state);
      if (edges != kBlocked) {
        group.edges = FourInt{} + edges;
        return;
      }
      for (int k = 0; k < 4; ++k) hits_[group.rays->ray[k]] = hit_of(quad, k, state);
      group.rays = nullptr;
      return;
    }
    // Put together in registers: the four are read back as one.
    group.edges = FourInt{visit(group, 0, far[0]), visit(group, 1, far[1]), visit(group, 2, far[2]),
                          visit(group, 3, far[3])};
    if (!group.alive) group.rays = nullptr;
  }

  __attribute__((always_inline)) int visit(Group& group, int k, bool far) {
    if (!(group.alive >> k & 1)) return 0;
    const std::size_t ray = group.rays->ray[k];
    const Quad& quad = group.rays->quad;
    if (far) {
      hits_[ray] = nothing_within(rays_[ray]);
    } else {
      VoxelState state;
      const int edges = look(group.place[k], quad, k, state);
      if (edges != kBlocked) return edges;
      hits_[ray] = hit_of(quad, k, state);
    }
    group.alive &= ~(1u << k);
    return 0;
  }

  // The edges of the box around the ray's cell in which all that lies ahead is free; kBlocked, and
  // how the cell is, where it is not free itself.
  __attribute__((always_inline)) int look(Place& place, const Quad& quad, int k,
                                          VoxelState& state) {
    if (quad.key[k] != place.key) enter_block(place, quad, k);
    if (!place.block) {
      state = VoxelState::unknown;
      return kBlocked;
    }
    const Block& block = *place.block;
    const Ahead& ahead = quad.ahead_of(k);
    const auto places = static_cast<unsigned>(quad.places[k]);
    const unsigned at = places >> 16;
    if (block.all_free >> at & 1)  // most often, and then the brick itself need not be fetched
      return ahead.edges[4 + all_of(block.all_free, ahead.some[at]) +
                         all_of(block.all_free, ahead.all[at])];
    if (!(block.bricked >> at & 1)) {
      state = state_of_brick(block, at);
      return kBlocked;
    }
    const DenseBrick& brick = *block.content[at].brick;
    const unsigned chunk = places >> 8 & 63, voxel = places & 63;
    const std::uint64_t free = brick.free[chunk];
    if (!(free >> voxel & 1)) {
      state = state_of_voxel(brick, chunk, voxel);
      return kBlocked;
    }
    // What lies ahead in ever larger boxes; their number is the level of the largest that is free.
    // Counted without branches, which nothing could predict.
    const std::uint64_t chunks = brick.all_free | std::uint64_t{1} << chunk;
    const std::uint64_t bricks = block.all_free | std::uint64_t{1} << at;
    const int chunk_free = all_of(free, ahead.all[voxel]);
    const int brick_free = chunk_free & all_of(chunks, ahead.all[chunk]);
    const int level = all_of(free, ahead.some[voxel]) + chunk_free +
                      (chunk_free & all_of(chunks, ahead.some[chunk])) + brick_free +
                      (brick_free & all_of(bricks, ahead.some[at])) +
                      (brick_free & all_of(bricks, ahead.all[at]));
    return ahead.edges[level];
  }

  static int all_of(std::uint64_t word, std::uint64_t parts) {
    return (~word & parts) == 0;
  }

  __attribute__((always_inline)) void enter_block(Place& place, const Quad& quad, int k) {
    const int key = quad.key[k], ahead = key - place.key, ascends = ~quad.descends[k];
    const Block*& block = place.block;
    place.key = key;
    // Rays ascend, and mostly leave a block through one face: its lower or its higher one.
    if (block && ahead == 1)
      block = block->next[ascends & 1][0];
    else if (block && ahead == 1 << 10)
      block = block->next[ascends >> 1 & 1][1];
    else if (block && ahead == 1 << 20)
      block = block->next[ascends >> 2 & 1][2];
    else
      block = find_block(quad, k);
  }

  const Block* find_block(const Quad& quad, int k) {
    int cell[3];
    for (int i = 0; i < 3; ++i) cell[i] = quad.cell[i][k] ^ mirror(quad.descends[k], i);
    if ((cell[0] | cell[1] | cell[2]) & ~0xffff) return nullptr;
    // Rays of a view start in the same block.
    const int key = key_of(cell[0], cell[1], cell[2]);
    if (key != found_key_) {
      found_key_ = key;
      found_ = bricks_.find(cell);
    }
    return found_;
  }

  static int mirror(int descends, int axis) {
    return (descends >> axis & 1) * 0xffff;
  }

  VoxelState state_of_brick(const Block& block, unsigned at) const {
    return block.known >> at & 1 ? settings_.state(block.content[at].log_odds)
                                 : VoxelState::unknown;
  }
  VoxelState state_of_voxel(const DenseBrick& brick, unsigned chunk, unsigned voxel) const {
    if (!(brick.known[chunk] >> voxel & 1)) return VoxelState::unknown;
    const int of = static_cast<int>(chunk);
    return settings_.state(brick.has_slot(of) ? bricks_.values(brick.content[of])[voxel]
                                              : brick.alike(of));
  }

  static MapRayHit hit_of(const Quad& quad, int k, VoxelState state) {
    const auto key = [&](int i) {
      return static_cast<std::uint16_t>(std::min(quad.cell[i][k], 0xffff) ^
                                        mirror(quad.descends[k], i));
    };
    return {{key(0), key(1), key(2)}, state, static_cast<float>(std::max(quad.entered[k], 0.0))};
  }

  const BrickGrid& bricks_;
  const MapSettings& settings_;
  VoxelGrid grid_;
  std::span<const MapRay> rays_;
  std::span<MapRayHit> hits_;
  std::size_t next_ = 0;
  std::int32_t found_key_ = -1;  // of the block that was looked up last
  const Block* found_ = nullptr;
  RayBeam beam_;
  int current_ = 0, started_ = 0;
  Batch batches_[2];  // the one at hand, and one that is ending
  Group groups_[kGroups];
};

#if defined(__x86_64__)
__attribute__((target("avx2,bmi,bmi2"))) void run_avx2(Caster& caster) {
  caster.run();
}
#endif

}  // namespace

void cast_rays(const BrickGrid& bricks, const MapSettings& settings, std::span<const MapRay> rays,
               std::span<MapRayHit> hits) {
  Caster caster(bricks, settings, rays, hits);
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) return run_avx2(caster);
#endif
  caster.run();
}

}  // namespace lapwing::brick_map
