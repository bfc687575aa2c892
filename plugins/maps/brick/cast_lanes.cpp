#include "plugins/maps/brick/cast_lanes.h"

#include "framework/map/ray_walk.h"
#include "plugins/maps/brick/free_box.h"

namespace lapwing::brick_map {
namespace {

using Four = double __attribute__((vector_size(32)));
using FourLong = std::int64_t __attribute__((vector_size(32)));
using FourInt = std::int32_t __attribute__((vector_size(16)));

// More than one group of four hides how long each waits for its numbers.
constexpr int kGroups = 2;
constexpr int kBeam = 64;  // rays: a tile of a view

// Four rays that go together until the last of them has ended. Cells are mirrored along the axes on
// which a ray descends, so that every ray ascends; aligned cubes stay aligned.
struct Quad {
  FourInt start[3];  // the cell that crossings are counted from
  Four first[3], spacing[3], rate[3];
  Four range;
  FourInt descends;  // axes, as bits
  FourInt mirrored;  // what the places must be mirrored with
  FourInt ahead;     // of its kAhead, in bytes

  FourInt cell[3];
  Four entered;
  FourInt edges;   // of the free box around the cell, as in Ahead
  FourInt key;     // of the block
  FourInt places;  // of voxel, chunk and brick, a byte each
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

// Rays before they start; up to distance `from` everything is known to be free.
struct Start {
  const VoxelGrid& grid;
  double from;

  __attribute__((always_inline)) void prepare(Quad& quad, const MapRay& a, const MapRay& b,
                                              const MapRay& c, const MapRay& d) const {
    quad.descends = FourInt{};
    Four size[3];
    for (int i = 0; i < 3; ++i) {
      const Four direction = {a.direction[i], b.direction[i], c.direction[i], d.direction[i]};
      const Four origin = {a.origin[i], b.origin[i], c.origin[i], d.origin[i]};
      prepare_axis(quad, i, direction, origin);
      size[i] = direction < 0 ? -direction : direction;
    }
    const Four by_x = 0.4 * size[0], by_y = 0.4 * size[1], by_z = 0.4 * size[2];
    const FourLong x = (by_x > size[1]) & (by_x > size[2]),
                   y = (by_y > size[0]) & (by_y > size[2]), z = (by_z > size[0]) & (by_z > size[1]);
    const FourInt along = kAlongNone + __builtin_convertvector(3 * x + 2 * y + z, FourInt);
    quad.ahead = (quad.descends | along << 3) * static_cast<int>(sizeof(Ahead));
    quad.mirrored =
        ((quad.descends & 1) * 3 | (quad.descends & 2) * 6 | (quad.descends & 4) * 12) * 0x010101;
    quad.range = Four{a.range, b.range, c.range, d.range};
    quad.entered = Four{};
    quad.key = key_of(quad.cell[0], quad.cell[1], quad.cell[2]);
    quad.places = places_of(quad.cell[0], quad.cell[1], quad.cell[2]) ^ quad.mirrored;
  }

 private:
  __attribute__((always_inline)) void prepare_axis(Quad& quad, int i, Four d, Four origin) const {
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
    const Four first = moves ? next : zero + RayWalk::kNever;
    const Four spacing = moves ? grid.resolution() * apart : zero;
    const Four rate = moves ? (falls ? -d : d) * grid.per_metre() : zero;
    const Four nearest = __builtin_convertvector(
        __builtin_convertvector((from - first) * rate + 0.5, FourInt), Four);
    const Four count = nearest + (first + nearest * spacing < from ? one : zero);
    const FourInt mirror = __builtin_convertvector(falls, FourInt);
    quad.first[i] = first;
    quad.spacing[i] = spacing;
    quad.rate[i] = rate;
    quad.start[i] = (__builtin_convertvector(index, FourInt) + kCenterKey) ^ (mirror & 0xffff);
    quad.cell[i] = quad.start[i] + __builtin_convertvector(count, FourInt);
    quad.descends |= mirror & (1 << i);
  }
};

// What goes on with four rays beside their numbers.
struct Group {
  Quad* quad = nullptr;    // none: idle
  unsigned alive = 0;      // rays that have not ended, as bits
  std::size_t ray = 0;     // the first of the four
  const Block* block[4] = {};
  std::int32_t block_key[4] = {};  // of the block at hand, as Quad's
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
        if (!group.quad) start(group);
        busy |= group.quad != nullptr;
      }
      if (!busy) return;
#pragma GCC unroll 1
      for (Group& group : groups_)
        if (group.quad) leave_boxes(*group.quad);
#pragma GCC unroll 1
      for (Group& group : groups_)
        if (group.quad) visit(group, group.quad->entered >= group.quad->range);
    }
  }

 private:
  // The next four rays that get anywhere; none when all are under way, or for as long as other
  // groups need the quads that the next beam would take.
  __attribute__((always_inline)) void start(Group& group) {
    while (!group.quad) {
      if (next_ == beam_end_ && !next_beam()) return;
      group.quad = &quads_[current_][(next_ - beam_first_) / 4];
      group.ray = next_;
      next_ = std::min(next_ + 4, beam_end_);
      group.alive = (1u << (next_ - group.ray)) - 1;
      for (int k = 0; k < 4; ++k) {
        group.block[k] = nullptr;
        group.block_key[k] = -1;
      }
      visit(group, FourLong{});
    }
  }

  __attribute__((always_inline)) bool next_beam() {
    if (next_ == rays_.size()) return false;
    const Quad* const quads = quads_[1 - current_];
    for (const Group& group : groups_)
      if (group.quad >= quads && group.quad < quads + kBeam / 4) return false;
    current_ = 1 - current_;
    beam_first_ = next_;
    find_beam();
    const Start start{grid_, beam_free_};
    const auto ray = [&](std::size_t k) -> const MapRay& {
      return rays_[std::min(k, beam_end_ - 1)];
    };
    Quad* quad = quads_[current_];
    for (std::size_t k = beam_first_; k < beam_end_; k += 4)
      start.prepare(*quad++, ray(k), ray(k + 1), ray(k + 2), ray(k + 3));
    return true;
  }

  __attribute__((always_inline)) void visit(Group& group, FourLong far) {
    // Put together in registers: the four are read back as one.
    group.quad->edges = FourInt{visit(group, 0, far[0]), visit(group, 1, far[1]),
                                visit(group, 2, far[2]), visit(group, 3, far[3])};
    if (!group.alive) group.quad = nullptr;
  }

  __attribute__((always_inline)) int visit(Group& group, int k, bool far) {
    if (!(group.alive >> k & 1)) return 0;
    const std::size_t ray = group.ray + static_cast<std::size_t>(k);
    if (far) {
      hits_[ray] = nothing_within(rays_[ray]);
    } else {
      const int edges = look(group, k, hits_[ray]);
      if (edges >= 0) return edges;
    }
    group.alive &= ~(1u << k);
    return 0;
  }

  // The edges of the box around the cell in which all that lies ahead is free. Negative, and the
  // hit noted, where the cell is not free.
  __attribute__((always_inline)) int look(Group& group, int k, MapRayHit& hit) {
    const Quad& quad = *group.quad;
    if (quad.key[k] != group.block_key[k] && !enter_block(group, k, hit)) return -1;
    const auto places = static_cast<unsigned>(quad.places[k]);
    const Block& block = *group.block[k];
    const Ahead& ahead = *reinterpret_cast<const Ahead*>(
        reinterpret_cast<const char*>(kAhead.data()) + quad.ahead[k]);
    const unsigned at = places >> 16;
    if (block.all_free >> at & 1)  // most often, and then the brick itself need not be fetched
      return ahead
          .edges[4 + all(block.all_free, ahead.some[at]) + all(block.all_free, ahead.all[at])];
    if (!(block.bricked >> at & 1)) return note(quad, k, state_of_brick(block, at), hit);
    const DenseBrick& brick = *block.content[at].brick;
    const unsigned chunk = places >> 8 & 63, voxel = places & 63;
    const std::uint64_t free = brick.free[chunk];
    if (!(free >> voxel & 1)) return note(quad, k, state_of_voxel(brick, chunk, voxel), hit);
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
  __attribute__((always_inline)) bool enter_block(Group& group, int k, MapRayHit& hit) {
    const Quad& quad = *group.quad;
    const std::int32_t key = quad.key[k], ahead = key - group.block_key[k];
    const int ascends = ~quad.descends[k];
    const Block*& block = group.block[k];
    group.block_key[k] = key;
    // Rays ascend, and mostly leave a block through one face: its lower or its higher one.
    if (block && ahead == 1)
      block = block->next[ascends & 1][0];
    else if (block && ahead == 1 << 10)
      block = block->next[ascends >> 1 & 1][1];
    else if (block && ahead == 1 << 20)
      block = block->next[ascends >> 2 & 1][2];
    else
      block = find_block(quad, k);
    if (block) return true;
    note(quad, k, VoxelState::unknown, hit);
    return false;
  }

  const Block* find_block(const Quad& quad, int k) {
    const int x = quad.cell[0][k], y = quad.cell[1][k], z = quad.cell[2][k];
    if ((x | y | z) & ~0xffff) return nullptr;
    const int cell[3] = {x ^ mirror(quad, k, 0), y ^ mirror(quad, k, 1), z ^ mirror(quad, k, 2)};
    // Rays of a view start in the same block.
    const std::int32_t key = cell[0] >> 6 | (cell[1] >> 6) << 10 | (cell[2] >> 6) << 20;
    if (key != found_key_) {
      found_key_ = key;
      found_ = bricks_.find(cell);
    }
    return found_;
  }

  static int mirror(const Quad& quad, int k, int i) { return (quad.descends[k] >> i & 1) * 0xffff; }

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

  static int note(const Quad& quad, int k, VoxelState state, MapRayHit& hit) {
    const auto key = [&](int i) {
      return static_cast<std::uint16_t>(std::min(quad.cell[i][k], 0xffff) ^ mirror(quad, k, i));
    };
    hit = {{key(0), key(1), key(2)}, state, static_cast<float>(std::max(quad.entered[k], 0.0))};
    return -1;
  }

  // Every ray to the first cell outside its free box. A crossing that is nearest to the way out
  // is decided by its own distance, all others are clear.
  __attribute__((always_inline)) static void leave_boxes(Quad& quad) {
    Four t[3];
    for (int i = 0; i < 3; ++i) {
      const FourInt made =
          quad.cell[i] - quad.start[i] + (~quad.cell[i] & (quad.edges >> 8 * i & 63));
      t[i] = quad.first[i] + __builtin_convertvector(made, Four) * quad.spacing[i];
    }
    const FourLong xy = t[0] < t[1], xz = t[0] < t[2], yz = t[1] < t[2];
    const FourLong by_x = xy & xz, by_xy = by_x | (~xy & yz);
    const Four at_xy = xy ? t[0] : t[1];
    const Four at = at_xy < t[2] ? at_xy : t[2];
    constexpr double kRounding = 6755399441055744.0;  // 1.5 * 2^52: adding it leaves no fraction
    for (int i = 0; i < 3; ++i) {
      const Four nearest = ((at - quad.first[i]) * quad.rate[i] + kRounding) - kRounding;
      const Four crossing = quad.first[i] + nearest * quad.spacing[i];
      // Crossings at one distance are made z before y before x.
      const FourLong made = i == 2   ? crossing <= at
                            : i == 1 ? (crossing < at) | ((crossing == at) & by_xy)
                                     : (crossing < at) | ((crossing == at) & by_x);
      const Four one = {1, 1, 1, 1};
      const Four count = nearest + (Four)((FourLong)one & made);
      quad.cell[i] = quad.start[i] + __builtin_convertvector(count, FourInt);
    }
    quad.entered = at;
    quad.key = key_of(quad.cell[0], quad.cell[1], quad.cell[2]);
    quad.places = places_of(quad.cell[0], quad.cell[1], quad.cell[2]) ^ quad.mirrored;
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
  int current_ = 0;               // of the two: the beam at hand, and one that is ending
  Quad quads_[2][kBeam / 4];
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
