#include "plugins/maps/brick/cast_lanes.h"

#include "framework/map/ray_walk.h"
#include "plugins/maps/brick/brick_reads.h"

namespace lapwing::brick_map {
namespace {

using Four = double __attribute__((vector_size(32)));
using FourLong = std::int64_t __attribute__((vector_size(32)));
using FourInt = std::int32_t __attribute__((vector_size(16)));

// Cells are mirrored along the axes on which a ray descends, so that every ray ascends; aligned
// cubes stay aligned.
struct Lanes {
  FourInt cell[3], start[3];  // mirrored
  Four first[3], spacing[3], rate[3];
  Four entered, range;
  FourInt low;  // edge of the free cube around the cell, less one
};

// By place: the parts that a ray from there can still come through in the 4^3 and in the 2^3
// around, itself among them.
struct Ahead {
  std::uint64_t all[64] = {}, eight[64] = {};
};

// By the axes along which a ray descends, as bits.
constexpr std::array<Ahead, 8> parts_ahead() {
  std::array<Ahead, 8> result{};
  for (int descends = 0; descends < 8; ++descends)
    for (int from = 0; from < 64; ++from)
      for (int to = 0; to < 64; ++to) {
        bool ahead = true, near = true;
        for (int i = 0; i < 3; ++i) {
          const int a = from >> 2 * i & 3, b = to >> 2 * i & 3;
          ahead &= descends >> i & 1 ? b <= a : b >= a;
          near &= a >> 1 == b >> 1;
        }
        if (!ahead) continue;
        result[descends].all[from] |= std::uint64_t{1} << to;
        if (near) result[descends].eight[from] |= std::uint64_t{1} << to;
      }
  return result;
}
constexpr std::array<Ahead, 8> kAhead = parts_ahead();

// A ray before it starts.
struct Start {
  int cell[3];    // mirrored
  int mirror[3];  // 0 or 65535
  double first[3], spacing[3], rate[3];
};

__attribute__((always_inline)) inline Start start_of(const VoxelGrid& grid, const MapRay& ray) {
  Start start;
  for (int i = 0; i < 3; ++i) {
    const double d = ray.direction[i];
    const int cell = grid.index(ray.origin[i]);
    start.mirror[i] = d < 0 ? 0xffff : 0;
    start.cell[i] = cell ^ start.mirror[i];
    const bool moves = std::abs(d) > RayWalk::kLevel;
    start.first[i] = moves ? (grid.face(cell + (d > 0)) - ray.origin[i]) / d : RayWalk::kNever;
    start.spacing[i] = moves ? grid.resolution() / std::abs(d) : 0;
    start.rate[i] = moves ? std::abs(d) * grid.per_metre() : 0;
  }
  return start;
}

// What one lane needs beside its numbers.
struct Lane {
  std::size_t ray = 0;
  int mirror[3] = {};      // 0 or 65535
  int mirrored_place = 0;  // of a part in its word
  const Ahead* ahead = nullptr;
  std::uint32_t block_key = 0;  // of mirrored cells, of the block at hand
  const Block* block = nullptr;
};

constexpr FourLong kLane[4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, -1}};
constexpr FourInt kIntLane[4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, -1}};

// More than one group hides how long each waits for its numbers.
constexpr int kGroups = 2, kLanes = 4 * kGroups;

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
    for (int lane = 0; lane < kLanes; ++lane) next_ray(lane);
    while (busy_) {
      for (Lanes& lanes : lanes_) leave_cubes(lanes);
      for (int group = 0; group < kGroups; ++group) visit(group);
      for (unsigned done = done_; done; done &= done - 1) next_ray(std::countr_zero(done));
      done_ = 0;
    }
  }

 private:
  __attribute__((always_inline)) void visit(int group) {
    Lanes& lanes = lanes_[group];
    const FourLong far = lanes.entered >= lanes.range;
    // Put together in registers: the four are read back as one.
    lanes.low = FourInt{visit(lanes, group, 0, far[0]), visit(lanes, group, 1, far[1]),
                        visit(lanes, group, 2, far[2]), visit(lanes, group, 3, far[3])};
  }

  __attribute__((always_inline)) int visit(const Lanes& lanes, int group, int k, bool far) {
    const int lane = 4 * group + k;
    if (far) {
      if (!(busy_ >> lane & 1)) return 0;
      hits_[lane_[lane].ray] = nothing_within(rays_[lane_[lane].ray]);
    } else {
      const int low =
          look(lane_[lane], lanes.cell[0][k], lanes.cell[1][k], lanes.cell[2][k], lanes.entered[k]);
      if (low >= 0) return low;
    }
    done_ |= 1u << lane;
    return 0;
  }

  // The edge, less one, of the cube around the cell (mirrored) in which all that lies ahead is
  // free. Negative, and the hit noted, where the cell is not free.
  __attribute__((always_inline)) int look(Lane& of, int x, int y, int z, double entered) {
    const auto key = static_cast<std::uint32_t>(x >> 6 | y >> 6 << 10 | z >> 6 << 20);
    if (key != of.block_key || ((x | y | z) & ~0xffff)) {
      if ((x | y | z) & ~0xffff) return hit(of, x, y, z, entered, VoxelState::unknown);
      const int cell[3] = {x ^ of.mirror[0], y ^ of.mirror[1], z ^ of.mirror[2]};
      of.block_key = key;
      of.block = bricks_.find(cell);
    }
    if (!of.block) return hit(of, x, y, z, entered, VoxelState::unknown);
    const Block& block = *of.block;
    const Ahead& ahead = *of.ahead;
    const int at = part(x, y, z, 4) ^ of.mirrored_place;
    if (!block.has_brick(at)) {
      if (!(block.all_free >> at & 1))
        return hit(of, x, y, z, entered, state_of(block.known, at, block.content[at].log_odds));
      return (16 << (all(block.all_free, ahead.eight[at]) + all(block.all_free, ahead.all[at]))) -
             1;
    }
    const DenseBrick& brick = *block.content[at].brick;
    const int chunk = part(x, y, z, 2) ^ of.mirrored_place;
    const std::uint64_t free = brick.free[chunk];
    const int voxel = part(x, y, z, 0) ^ of.mirrored_place;
    if (!(free >> voxel & 1)) {
      const float log_odds =
          brick.has_slot(chunk) ? bricks_.values(brick.content[chunk])[voxel] : brick.alike(chunk);
      return hit(of, x, y, z, entered, state_of(brick.known[chunk], voxel, log_odds));
    }
    // What lies ahead in ever larger cubes; their number is the level of the largest that is free.
    // Counted without branches, which nothing could predict.
    const std::uint64_t chunks = brick.all_free | bit(chunk), bricks = block.all_free | bit(at);
    const int chunk_free = all(free, ahead.all[voxel]);
    const int brick_free = chunk_free & all(chunks, ahead.all[chunk]);
    const int level = all(free, ahead.eight[voxel]) + chunk_free +
                      (chunk_free & all(chunks, ahead.eight[chunk])) + brick_free +
                      (brick_free & all(bricks, ahead.eight[at])) +
                      (brick_free & all(bricks, ahead.all[at]));
    return (1 << level) - 1;
  }

  static int all(std::uint64_t word, std::uint64_t parts) { return (word & parts) == parts; }

  static int part(int x, int y, int z, int shift) {
    return (x >> shift & 3) | (y >> shift & 3) << 2 | (z >> shift & 3) << 4;
  }

  VoxelState state_of(std::uint64_t known, int place, float log_odds) const {
    return known >> place & 1 ? settings_.state(log_odds) : VoxelState::unknown;
  }

  int hit(const Lane& of, int x, int y, int z, double entered, VoxelState state) {
    const auto key = [&](int cell, int i) {
      return static_cast<std::uint16_t>(std::min(cell, 0xffff) ^ of.mirror[i]);
    };
    hits_[of.ray] = {
        {key(x, 0), key(y, 1), key(z, 2)}, state, static_cast<float>(std::max(entered, 0.0))};
    return -1;
  }

  // Every lane to the first cell outside its free cube. A crossing that is nearest to the way out
  // is decided by its own distance, all others are clear.
  __attribute__((always_inline)) static void leave_cubes(Lanes& lanes) {
    Four t[3];
    for (int i = 0; i < 3; ++i) {
      const FourInt made = lanes.cell[i] - lanes.start[i] + (~lanes.cell[i] & lanes.low);
      t[i] = lanes.first[i] + __builtin_convertvector(made, Four) * lanes.spacing[i];
    }
    const FourLong xy = t[0] < t[1], xz = t[0] < t[2], yz = t[1] < t[2];
    const FourLong by_x = xy & xz, by_xy = by_x | (~xy & yz);
    const Four at_xy = xy ? t[0] : t[1];
    const Four at = at_xy < t[2] ? at_xy : t[2];
    for (int i = 0; i < 3; ++i) {
      const FourInt nearest =
          __builtin_convertvector((at - lanes.first[i]) * lanes.rate[i] + 0.5, FourInt);
      const Four crossing =
          lanes.first[i] + __builtin_convertvector(nearest, Four) * lanes.spacing[i];
      // Crossings at one distance are made z before y before x.
      const FourLong made = i == 2   ? crossing <= at
                            : i == 1 ? (crossing < at) | ((crossing == at) & by_xy)
                                     : (crossing < at) | ((crossing == at) & by_x);
      lanes.cell[i] = lanes.start[i] + nearest - __builtin_convertvector(made, FourInt);
    }
    lanes.entered = at;
  }

  // Fills a lane with the next ray that gets anywhere; without one the lane stays where it is.
  __attribute__((always_inline)) void next_ray(int lane) {
    Lane& of = lane_[lane];
    while (next_ < rays_.size()) {
      of.ray = next_++;
      const MapRay& ray = rays_[of.ray];
      const Start start = start_of(grid_, ray);
      int descends = 0;
      of.mirrored_place = 0;
      for (int i = 0; i < 3; ++i) {
        of.mirror[i] = start.mirror[i];
        of.mirrored_place |= start.mirror[i] & 3 << 2 * i;
        descends |= start.mirror[i] & 1 << i;
      }
      of.ahead = &kAhead[static_cast<std::size_t>(descends)];
      of.block_key = ~0u;
      const int low = look(of, start.cell[0], start.cell[1], start.cell[2], 0);
      if (low < 0) continue;
      fill(lane, start, low, ray.range);
      busy_ |= 1u << lane;
      return;
    }
    busy_ &= ~(1u << lane);
    fill(lane, Start{}, 0, -1);
  }

  // Whole vectors are written: parts of them could not be read back as one without a wait.
  __attribute__((always_inline)) void fill(int lane, const Start& start, int low, double range) {
    Lanes& lanes = lanes_[lane / 4];
    const FourLong here = kLane[lane % 4];
    const FourInt here_int = kIntLane[lane % 4];
    for (int i = 0; i < 3; ++i) {
      const Four first = {start.first[i], start.first[i], start.first[i], start.first[i]};
      const Four spacing = {start.spacing[i], start.spacing[i], start.spacing[i], start.spacing[i]};
      const Four rate = {start.rate[i], start.rate[i], start.rate[i], start.rate[i]};
      const FourInt cell = {start.cell[i], start.cell[i], start.cell[i], start.cell[i]};
      lanes.first[i] = here ? first : lanes.first[i];
      lanes.spacing[i] = here ? spacing : lanes.spacing[i];
      lanes.rate[i] = here ? rate : lanes.rate[i];
      lanes.cell[i] = here_int ? cell : lanes.cell[i];
      lanes.start[i] = here_int ? cell : lanes.start[i];
    }
    const Four ranges = {range, range, range, range};
    const FourInt lows = {low, low, low, low};
    lanes.range = here ? ranges : lanes.range;
    lanes.low = here_int ? lows : lanes.low;
  }

  const BrickGrid& bricks_;
  const MapSettings& settings_;
  VoxelGrid grid_;
  std::span<const MapRay> rays_;
  std::span<MapRayHit> hits_;
  std::size_t next_ = 0;
  unsigned done_ = 0, busy_ = 0;  // lanes, as bits
  Lanes lanes_[kGroups] = {};
  Lane lane_[kLanes];
};

#if defined(__x86_64__)
__attribute__((target("avx2"))) void run_avx2(Caster& caster) {
  caster.run();
}
#endif

}  // namespace

void cast_rays(const BrickGrid& bricks, const MapSettings& settings, std::span<const MapRay> rays,
               std::span<MapRayHit> hits) {
  Caster caster(bricks, settings, rays, hits);
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return run_avx2(caster);
#endif
  caster.run();
}

}  // namespace lapwing::brick_map
