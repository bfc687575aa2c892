#include "plugins/maps/brick/cast_lanes.h"

#include "framework/map/ray_walk.h"
#include "plugins/maps/brick/free_box.h"

namespace lapwing::brick_map {
namespace {

using Four = double __attribute__((vector_size(32)));
using FourLong = std::int64_t __attribute__((vector_size(32)));
using FourInt = std::int32_t __attribute__((vector_size(16)));

// More than one group of four hides how long each waits for its numbers.
constexpr int kGroups = 2, kLanes = 4 * kGroups;
constexpr std::size_t kBeam = 64;  // rays: a tile of a view

// Cells are mirrored along the axes on which a ray descends, so that every ray ascends; aligned
// cubes stay aligned.
struct Lanes {
  FourInt cell[3], start[3];  // mirrored
  Four first[3], spacing[3], rate[3];
  Four entered, range;
  FourInt edges;     // of the free box around the cell, as in Ahead
  FourInt key;       // of the block, mirrored
  FourInt places;    // of voxel, chunk and brick, a byte each
  FourInt mirrored;  // what the places must be mirrored with
};

// By place: the parts that a ray from there can still come through in the 4^3 around, and in a
// smaller box of them; itself among them.
struct Ahead {
  std::uint64_t all[64] = {}, some[64] = {};
  // Edges, less one, of the box that is left by its level, a byte for each axis: one voxel, some
  // and all of a chunk, some and all of a brick's chunks, some and all of a block's bricks.
  std::int32_t edges[7] = {};
};

// The smaller box is a cube of 2^3, or a row of four for rays that mostly go along one axis.
constexpr int kAlongNone = 3;
constexpr Ahead parts_ahead(int descends, int along) {
  Ahead result;
  for (int from = 0; from < 64; ++from)
    for (int to = 0; to < 64; ++to) {
      bool ahead = true, near = true;
      for (int i = 0; i < 3; ++i) {
        const int a = from >> 2 * i & 3, b = to >> 2 * i & 3;
        ahead &= descends >> i & 1 ? b <= a : b >= a;
        near &= along == kAlongNone ? a >> 1 == b >> 1 : i == along || a == b;
      }
      if (!ahead) continue;
      result.all[from] |= std::uint64_t{1} << to;
      if (near) result.some[from] |= std::uint64_t{1} << to;
    }
  for (int level = 0; level < 7; ++level) {
    const int edge = (1 << (along == kAlongNone ? level : level & ~1)) - 1;
    result.edges[level] = edge | edge << 8 | edge << 16;
    if (along != kAlongNone && level % 2) result.edges[level] |= (4 * edge + 3) << 8 * along;
  }
  return result;
}

// By the axis that rays go along, then by the axes along which they descend, as bits.
constexpr std::array<Ahead, 32> all_parts_ahead() {
  std::array<Ahead, 32> result{};
  for (int k = 0; k < 32; ++k) result[static_cast<std::size_t>(k)] = parts_ahead(k & 7, k >> 3);
  return result;
}
constexpr std::array<Ahead, 32> kAhead = all_parts_ahead();

__attribute__((always_inline)) inline FourInt spread(FourInt x) {
  x &= 63;
  return (x | x << 6 | x << 12) & 0x030303;
}
// Of mirrored cells: the block, and voxel, chunk and brick in it, a byte each.
__attribute__((always_inline)) inline FourInt key_of(const FourInt& x, const FourInt& y,
                                                     const FourInt& z) {
  return x >> 6 | (y >> 6) << 10 | (z >> 6) << 20;
}
__attribute__((always_inline)) inline FourInt places_of(const FourInt& x, const FourInt& y,
                                                        const FourInt& z) {
  return spread(x) | spread(y) << 2 | spread(z) << 4;
}

// Rays before they start.
struct Starts {
  FourInt key[kBeam / 4], places[kBeam / 4], mirrored[kBeam / 4];  // as in Lanes
  FourInt cell[3][kBeam / 4],
      start[3][kBeam / 4];  // mirrored; counted from `start`, going on at `cell`
  FourInt descends[kBeam / 4], along[kBeam / 4];  // axes, as bits; an axis or kAlongNone
  Four first[3][kBeam / 4], spacing[3][kBeam / 4], rate[3][kBeam / 4];

  // Up to distance `from` everything is known to be free.
  __attribute__((always_inline)) void prepare(const VoxelGrid& grid, std::span<const MapRay> rays,
                                              double from) {
    const int groups = static_cast<int>(rays.size() + 3) / 4;
    for (int g = 0; g < groups; ++g) {
      const auto ray = [&](int k) -> const MapRay& {
        return rays[std::min(rays.size() - 1, static_cast<std::size_t>(4 * g + k))];
      };
      descends[g] = FourInt{};
      Four size[3];
      for (int i = 0; i < 3; ++i) {
        const Four d = {ray(0).direction[i], ray(1).direction[i], ray(2).direction[i],
                        ray(3).direction[i]};
        const Four origin = {ray(0).origin[i], ray(1).origin[i], ray(2).origin[i],
                             ray(3).origin[i]};
        prepare_axis(grid, i, g, d, origin, from);
        size[i] = d < 0 ? -d : d;
      }
      const Four by_x = 0.4 * size[0], by_y = 0.4 * size[1], by_z = 0.4 * size[2];
      const FourLong x = (by_x > size[1]) & (by_x > size[2]),
                     y = (by_y > size[0]) & (by_y > size[2]),
                     z = (by_z > size[0]) & (by_z > size[1]);
      along[g] = 3 + __builtin_convertvector(3 * x + 2 * y + z, FourInt);
      mirrored[g] =
          ((descends[g] & 1) * 3 | (descends[g] & 2) * 6 | (descends[g] & 4) * 12) * 0x010101;
      key[g] = key_of(cell[0][g], cell[1][g], cell[2][g]);
      places[g] = places_of(cell[0][g], cell[1][g], cell[2][g]) ^ mirrored[g];
    }
  }

 private:
  __attribute__((always_inline)) void prepare_axis(const VoxelGrid& grid, int i, int g, Four d,
                                                   Four origin, double from) {
    const Four zero = {}, one = zero + 1;
    const FourLong falls = d < zero, moves = (d > RayWalk::kLevel) | (d < -RayWalk::kLevel);
    // VoxelGrid's arithmetic.
    const Four voxels = grid.per_metre() * origin;
    const Four towards_zero =
        __builtin_convertvector(__builtin_convertvector(voxels, FourInt), Four);
    const Four index = towards_zero - (voxels < towards_zero ? one : zero);
    const Four face = (index + (d > zero ? one : zero)) * grid.resolution();
    const Four per_metre = one / d;
    const Four next = (face - origin) * per_metre, apart = d < zero ? -per_metre : per_metre;
    first[i][g] = moves ? next : zero + RayWalk::kNever;
    spacing[i][g] = moves ? grid.resolution() * apart : zero;
    rate[i][g] = moves ? (falls ? -d : d) * grid.per_metre() : zero;
    const Four nearest = __builtin_convertvector(
        __builtin_convertvector((from - first[i][g]) * rate[i][g] + 0.5, FourInt), Four);
    const Four count = nearest + (first[i][g] + nearest * spacing[i][g] < from ? one : zero);
    const FourInt mirror = __builtin_convertvector(falls, FourInt);
    start[i][g] = (__builtin_convertvector(index, FourInt) + kCenterKey) ^ (mirror & 0xffff);
    cell[i][g] = start[i][g] + __builtin_convertvector(count, FourInt);
    descends[g] |= mirror & (1 << i);
  }
};

// What one lane needs beside its numbers.
struct Lane {
  const Block* block = nullptr;
  const Ahead* ahead = nullptr;
  std::int32_t block_key = 0;  // of the block at hand
  int mirror[3] = {};          // 0 or 65535
  int side[3] = {1, 1, 1};     // of a block through which the ray leaves: 0 lower, 1 higher
  std::size_t ray = 0;
};

constexpr FourLong kLane[4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, -1}};
constexpr FourInt kIntLane[4] = {{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, -1}};

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
#pragma GCC unroll 1
      for (Lanes& lanes : lanes_) leave_boxes(lanes);
#pragma GCC unroll 1
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
    lanes.edges = FourInt{visit(lanes, group, 0, far[0]), visit(lanes, group, 1, far[1]),
                          visit(lanes, group, 2, far[2]), visit(lanes, group, 3, far[3])};
  }

  __attribute__((always_inline)) int visit(const Lanes& lanes, int group, int k, bool far) {
    const int lane = 4 * group + k;
    if (far) {
      if (!(busy_ >> lane & 1)) return 0;
      hits_[lane_[lane].ray] = nothing_within(rays_[lane_[lane].ray]);
    } else {
      const int edges = look(lanes, lane, k);
      if (edges >= 0) return edges;
    }
    done_ |= 1u << lane;
    return 0;
  }

  // The edges of the box around the cell in which all that lies ahead is free. Negative, and the
  // hit noted, where the cell is not free.
  __attribute__((always_inline)) int look(const Lanes& lanes, int lane, int k) {
    Lane& of = lane_[lane];
    if (lanes.key[k] != of.block_key && !enter_block(lanes, of, k)) return -1;
    const auto places = static_cast<unsigned>(lanes.places[k]);
    const Block& block = *of.block;
    const Ahead& ahead = *of.ahead;
    const unsigned at = places >> 16;
    if (block.all_free >> at & 1)  // most often, and then the brick itself need not be fetched
      return ahead
          .edges[4 + all(block.all_free, ahead.some[at]) + all(block.all_free, ahead.all[at])];
    if (!(block.bricked >> at & 1)) return hit(lanes, of, k, state_of_brick(block, at));
    const DenseBrick& brick = *block.content[at].brick;
    const unsigned chunk = places >> 8 & 63, voxel = places & 63;
    const std::uint64_t free = brick.free[chunk];
    if (!(free >> voxel & 1)) return hit(lanes, of, k, state_of_voxel(brick, chunk, voxel));
    // What lies ahead in ever larger boxes; their number is the level of the largest that is free.
    // Counted without branches, which nothing could predict.
    const std::uint64_t chunks = brick.all_free | std::uint64_t{1} << chunk;
    const std::uint64_t bricks = block.all_free | std::uint64_t{1} << at;
    const int chunk_free = all(free, ahead.all[voxel]);
    const int brick_free = chunk_free & all(chunks, ahead.all[chunk]);
    const int level = all(free, ahead.some[voxel]) + chunk_free +
                      (chunk_free & all(chunks, ahead.some[chunk])) + brick_free +
                      (brick_free & all(bricks, ahead.some[at])) +
                      (brick_free & all(bricks, ahead.all[at]));
    return ahead.edges[level];
  }

  static int all(std::uint64_t word, std::uint64_t parts) { return (~word & parts) == 0; }

  // False, and the hit noted, where there is none.
  __attribute__((always_inline)) bool enter_block(const Lanes& lanes, Lane& of, int k) {
    const std::int32_t key = lanes.key[k], ahead = key - of.block_key;
    of.block_key = key;
    // Rays ascend, and mostly leave a block through one face.
    if (of.block && ahead == 1)
      of.block = of.block->next[of.side[0]][0];
    else if (of.block && ahead == 1 << 10)
      of.block = of.block->next[of.side[1]][1];
    else if (of.block && ahead == 1 << 20)
      of.block = of.block->next[of.side[2]][2];
    else
      of.block = find_block(lanes, of, k);
    if (of.block) return true;
    hit(lanes, of, k, VoxelState::unknown);
    of.block_key = -1;
    return false;
  }

  const Block* find_block(const Lanes& lanes, const Lane& of, int k) {
    const int x = lanes.cell[0][k], y = lanes.cell[1][k], z = lanes.cell[2][k];
    if ((x | y | z) & ~0xffff) return nullptr;
    const int cell[3] = {x ^ of.mirror[0], y ^ of.mirror[1], z ^ of.mirror[2]};
    // Rays of a view start in the same block.
    const std::int32_t key = cell[0] >> 6 | (cell[1] >> 6) << 10 | (cell[2] >> 6) << 20;
    if (key != found_key_) {
      found_key_ = key;
      found_ = bricks_.find(cell);
    }
    return found_;
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

  int hit(const Lanes& lanes, const Lane& of, int k, VoxelState state) {
    const auto key = [&](int i) {
      return static_cast<std::uint16_t>(std::min(lanes.cell[i][k], 0xffff) ^ of.mirror[i]);
    };
    hits_[of.ray] = {
        {key(0), key(1), key(2)}, state, static_cast<float>(std::max(lanes.entered[k], 0.0))};
    return -1;
  }

  // Every lane to the first cell outside its free box. A crossing that is nearest to the way out
  // is decided by its own distance, all others are clear.
  __attribute__((always_inline)) static void leave_boxes(Lanes& lanes) {
    Four t[3];
    for (int i = 0; i < 3; ++i) {
      const FourInt made =
          lanes.cell[i] - lanes.start[i] + (~lanes.cell[i] & (lanes.edges >> 8 * i & 63));
      t[i] = lanes.first[i] + __builtin_convertvector(made, Four) * lanes.spacing[i];
    }
    const FourLong xy = t[0] < t[1], xz = t[0] < t[2], yz = t[1] < t[2];
    const FourLong by_x = xy & xz, by_xy = by_x | (~xy & yz);
    const Four at_xy = xy ? t[0] : t[1];
    const Four at = at_xy < t[2] ? at_xy : t[2];
    constexpr double kRounding = 6755399441055744.0;  // 1.5 * 2^52: adding it leaves no fraction
    for (int i = 0; i < 3; ++i) {
      const Four nearest = ((at - lanes.first[i]) * lanes.rate[i] + kRounding) - kRounding;
      const Four crossing = lanes.first[i] + nearest * lanes.spacing[i];
      // Crossings at one distance are made z before y before x.
      const FourLong made = i == 2   ? crossing <= at
                            : i == 1 ? (crossing < at) | ((crossing == at) & by_xy)
                                     : (crossing < at) | ((crossing == at) & by_x);
      const Four one = {1, 1, 1, 1};
      const Four count = nearest + (Four)((FourLong)one & made);
      lanes.cell[i] = lanes.start[i] + __builtin_convertvector(count, FourInt);
    }
    lanes.entered = at;
    lanes.key = key_of(lanes.cell[0], lanes.cell[1], lanes.cell[2]);
    lanes.places = places_of(lanes.cell[0], lanes.cell[1], lanes.cell[2]) ^ lanes.mirrored;
  }

  // Fills a lane with the next ray that gets anywhere; without one the lane stays where it is.
  __attribute__((always_inline)) void next_ray(int lane) {
    Lane& of = lane_[lane];
    while (next_ < rays_.size()) {
      if (next_ == beam_end_) {
        find_beam();
        beam_first_ = next_;
        starts_.prepare(grid_, rays_.subspan(next_, beam_end_ - next_), beam_free_);
      }
      of.ray = next_++;
      const auto place = static_cast<int>(of.ray - beam_first_);
      const int descends = starts_.descends[place / 4][place % 4];
      for (int i = 0; i < 3; ++i) {
        of.side[i] = ~descends >> i & 1;
        of.mirror[i] = (descends >> i & 1) * 0xffff;
      }
      of.block = nullptr;
      of.ahead =
          &kAhead[static_cast<std::size_t>(descends | starts_.along[place / 4][place % 4] << 3)];
      of.block_key = -1;
      fill(lane, place, rays_[of.ray].range);
      const int edges = look(lanes_[lane / 4], lane, lane % 4);
      if (edges < 0) continue;
      const FourInt four = {edges, edges, edges, edges};
      lanes_[lane / 4].edges = kIntLane[lane % 4] ? four : lanes_[lane / 4].edges;
      busy_ |= 1u << lane;
      return;
    }
    busy_ &= ~(1u << lane);
    lanes_[lane / 4].range = kLane[lane % 4] ? Four{-1, -1, -1, -1} : lanes_[lane / 4].range;
  }

  // Whole vectors are written: parts of them could not be read back as one without a wait.
  __attribute__((always_inline)) void fill(int lane, int place, double range) {
    Lanes& lanes = lanes_[lane / 4];
    const FourLong here = kLane[lane % 4];
    const FourInt here_int = kIntLane[lane % 4];
    const auto set = [&](Four& four, double value) {
      const Four values = {value, value, value, value};
      four = here ? values : four;
    };
    const auto set_int = [&](FourInt& four, int value) {
      const FourInt values = {value, value, value, value};
      four = here_int ? values : four;
    };
    for (int i = 0; i < 3; ++i) {
      const int g = place / 4, k = place % 4;
      set(lanes.first[i], starts_.first[i][g][k]);
      set(lanes.spacing[i], starts_.spacing[i][g][k]);
      set(lanes.rate[i], starts_.rate[i][g][k]);
      set_int(lanes.cell[i], starts_.cell[i][g][k]);
      set_int(lanes.start[i], starts_.start[i][g][k]);
    }
    set(lanes.entered, 0);
    set(lanes.range, range);
    set_int(lanes.mirrored, starts_.mirrored[place / 4][place % 4]);
    set_int(lanes.key, starts_.key[place / 4][place % 4]);
    set_int(lanes.places, starts_.places[place / 4][place % 4]);
  }

  // Rays next to each other from one place, as of a view, go through the same free space: how far
  // all of them are free is found once.
  void find_beam() {
    beam_free_ = 0;
    beam_end_ = std::min(rays_.size(), next_ + kBeam);
    const MapRay& lead = rays_[next_];
    Eigen::Vector3d least = lead.direction, most = lead.direction;
    double range = lead.range;
    for (std::size_t k = next_ + 1; k < beam_end_; ++k) {
      const MapRay& ray = rays_[k];
      if (ray.origin != lead.origin || (ray.direction - lead.direction).squaredNorm() > 0.02)
        return;
      least = least.cwiseMin(ray.direction);
      most = most.cwiseMax(ray.direction);
      range = std::min(range, ray.range);
    }
    if (beam_end_ - next_ < 8) return;
    const double shortest = 2 * settings_.resolution;
    double step = 16 * settings_.resolution;
    while (step >= shortest) {
      const double to = std::min(beam_free_ + step, range);
      if (beam_free(lead.origin, least, most, beam_free_, to))
        beam_free_ = to;
      else
        step /= 2;
      if (beam_free_ >= range) break;
    }
  }

  // Whether every voxel that a ray between the two directions comes through is free, between two
  // distances.
  bool beam_free(const Eigen::Vector3d& origin, const Eigen::Vector3d& least,
                 const Eigen::Vector3d& most, double from, double to) const {
    int low[3], high[3];
    const double margin = 1e-6 * settings_.resolution;  // far more than rounding
    for (int i = 0; i < 3; ++i) {
      const double a = origin[i] + std::min(least[i] * from, least[i] * to) - margin;
      const double b = origin[i] + std::max(most[i] * from, most[i] * to) + margin;
      if (a < -grid_.reach() || b >= grid_.reach()) return false;
      low[i] = grid_.index(a);
      high[i] = grid_.index(b);
    }
    return box_free(bricks_, low, high);
  }

  const BrickGrid& bricks_;
  const MapSettings& settings_;
  VoxelGrid grid_;
  std::span<const MapRay> rays_;
  std::span<MapRayHit> hits_;
  std::size_t next_ = 0, beam_first_ = 0, beam_end_ = 0;
  double beam_free_ = 0;          // m
  std::int32_t found_key_ = -1;   // of the block that was looked up last
  const Block* found_ = nullptr;
  unsigned done_ = 0, busy_ = 0;  // lanes, as bits
  Starts starts_;
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
