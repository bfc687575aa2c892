// SPDX-License-Identifier: Apache-2.0
// Four rays through the bricks at once, and the free boxes that they leave in one step.
//
// Cells are mirrored along the axes on which a ray descends, so that every ray ascends; aligned
// cubes stay aligned.
#pragma once

#include <array>

#include "framework/map/ray_walk.h"
#include "plugins/maps/brick/brick_grid.h"

namespace lapwing::brick_map {

using Four = double __attribute__((vector_size(32)));
using FourLong = std::int64_t __attribute__((vector_size(32)));
using FourInt = std::int32_t __attribute__((vector_size(16)));

// Whether a mask holds for no ray.
__attribute__((always_inline)) inline bool none(const FourLong& mask) {
  const FourLong two = mask | __builtin_shuffle(mask, FourLong{2, 3, 0, 1});
  return (two[0] | two[1]) == 0;
}

// By place: the parts that a ray from there can still come through in the 4^3 around, and in a
// smaller box of them; itself among them.
struct Ahead {
  std::uint64_t all[64] = {}, some[64] = {};
  // Edges, less one, of the box that is left by its level, a byte for each axis: one voxel, some
  // and all of a chunk, some and all of a brick's chunks, some and all of a block's bricks.
  std::int32_t edges[7] = {};
};

// The smaller box is a cube of 2^3, or a row of four for rays that mostly go along one axis.
inline constexpr int kAlongNone = 3;
constexpr Ahead parts_ahead(int descends, int along) {
  Ahead result;
  for (int from = 0; from < 64; ++from)
    for (int to = 0; to < 64; ++to) {
      bool ahead = true, near = true;
#pragma GCC unroll 3
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
inline constexpr std::array<Ahead, 32> kAhead = all_parts_ahead();

// Of a box by its edges as above: those of one axis.
template <class Edges>
__attribute__((always_inline)) inline Edges edge_of(const Edges& edges, int axis) {
  return edges >> 8 * axis & 63;
}

// What a mirrored place must be mirrored with to be a true one, by the axes as bits.
template <class Bits>
__attribute__((always_inline)) inline Bits mirror_of_places(const Bits& descends) {
  return ((descends & 1) * 3 | (descends & 2) * 6 | (descends & 4) * 12) * 0x010101;
}
// Of cells: the block, and voxel, chunk and brick in it, a byte each.
template <class Cells>
__attribute__((always_inline)) inline Cells key_of(const Cells& x, const Cells& y, const Cells& z) {
  return x >> 6 | (y >> 6) << 10 | (z >> 6) << 20;
}
template <class Cells>
__attribute__((always_inline)) inline Cells places_of(const Cells& x, const Cells& y,
                                                      const Cells& z) {
  const auto spread = [](const Cells& cell) __attribute__((always_inline)) {
    const Cells in_block = cell & 63;
    return (in_block | in_block << 6 | in_block << 12) & 0x030303;
  };
  return spread(x) | spread(y) << 2 | spread(z) << 4;
}

// Along one axis from a place: how rays that ascend, or that descend, come to their first face.
// Numbers is double where one place serves four rays, or Four.
template <class Numbers, class Cells>
struct AxisStart {
  Cells cell;                   // not mirrored
  Numbers to_lower, to_higher;  // faces of the cell, m; to_lower is negative or 0
};

struct Quad {
  FourInt start[3];                    // the cell that crossings are counted from
  Four first[3], spacing[3], rate[3];  // of crossings: m, m, per m
  FourInt descends;                    // axes, as bits
  FourInt mirrored;                    // what places must be mirrored with
  FourInt ahead;                       // of its kAhead, in bytes

  FourInt cell[3];
  FourInt key;     // of the block
  FourInt places;  // of voxel, chunk and brick, a byte each
  Four entered;    // m

  // Rays before they start, in RayWalk's arithmetic.
  template <class Numbers, class Cells>
  __attribute__((always_inline)) void prepare(const VoxelGrid& grid,
                                              const AxisStart<Numbers, Cells> from[3],
                                              const Four direction[3]) {
    const Four zero = {};
    descends = FourInt{};
    Four size[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const Four d = direction[i];
      const FourLong falls = d < zero, moves = (d > RayWalk::kLevel) | (d < -RayWalk::kLevel);
      const Four per_metre = 1 / d;
      const Four next = (d > zero ? zero + from[i].to_higher : zero + from[i].to_lower) * per_metre;
      size[i] = falls ? -d : d;
      first[i] = moves ? next : zero + RayWalk::kNever;
      spacing[i] = moves ? grid.resolution() * (falls ? -per_metre : per_metre) : zero;
      rate[i] = moves ? size[i] * grid.per_metre() : zero;
      const FourInt mirror = __builtin_convertvector(falls, FourInt);
      cell[i] = start[i] = from[i].cell ^ (mirror & 0xffff);
      descends |= mirror & (1 << i);
    }
    const Four by_x = 0.4 * size[0], by_y = 0.4 * size[1], by_z = 0.4 * size[2];
    const FourLong x = (by_x > size[1]) & (by_x > size[2]), y = (by_y > size[0]) & (by_y > size[2]),
                   z = (by_z > size[0]) & (by_z > size[1]);
    const FourInt along = kAlongNone + __builtin_convertvector(3 * x + 2 * y + z, FourInt);
    ahead = (descends | along << 3) * static_cast<int>(sizeof(Ahead));
    mirrored = mirror_of_places(descends);
    entered = zero;
    find_places();
  }

  const Ahead& ahead_of(int ray) const {
    return *reinterpret_cast<const Ahead*>(reinterpret_cast<const char*>(kAhead.data()) +
                                           ahead[ray]);
  }

  // Every ray to the first cell outside a box around its own, of such edges. The crossing that is
  // nearest to the way out is decided by its own distance, all others are clear.
  __attribute__((always_inline)) void leave_boxes(const FourInt& edges) {
    Four t[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const FourInt made = cell[i] - start[i] + (~cell[i] & edge_of(edges, i));
      t[i] = first[i] + __builtin_convertvector(made, Four) * spacing[i];
    }
    const FourLong xy = t[0] < t[1], xz = t[0] < t[2], yz = t[1] < t[2];
    const FourLong by_x = xy & xz, by_xy = by_x | (~xy & yz);
    const Four at_xy = xy ? t[0] : t[1];
    const Four at = at_xy < t[2] ? at_xy : t[2];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const Four number = nearest(i, at);
      const Four crossing = first[i] + number * spacing[i];
      // Crossings at one distance are made z before y before x.
      move(i, number,
           i == 2   ? crossing <= at
           : i == 1 ? (crossing < at) | ((crossing == at) & by_xy)
                    : (crossing < at) | ((crossing == at) & by_x));
    }
    entered = at;
    find_places();
  }

  // Every ray from its start to a distance that is not 0.
  __attribute__((always_inline)) void go_to(double at) {
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const Four number = nearest(i, at);
      move(i, number, first[i] + number * spacing[i] < at);
    }
    entered = Four{} + at;
    find_places();
  }

  // Whether all are in one cell, and will leave it over the same faces.
  __attribute__((always_inline)) bool together() const {
    const FourInt apart = (key ^ key[0]) | (places ^ places[0]) | (ahead ^ ahead[0]);
    const FourInt two = apart | __builtin_shuffle(apart, FourInt{2, 3, 0, 1});
    return (two[0] | two[1]) == 0;
  }

 private:
  // The number of the crossing along axis i that is nearest to a distance. Those that a ray would
  // have made before its start do not count, near as they are where it starts on a face.
  template <class Numbers>
  __attribute__((always_inline)) Four nearest(int i, const Numbers& at) const {
    constexpr double kRounding = 6755399441055744.0;  // 1.5 * 2^52: adding it leaves no fraction
    const Four number = ((at - first[i]) * rate[i] + kRounding) - kRounding;
    return number > 0 ? number : Four{};
  }

  // To the cell after crossing `number`, or before it.
  __attribute__((always_inline)) void move(int i, const Four& number, const FourLong& made) {
    const Four one = {1, 1, 1, 1};
    const Four count = number + (Four)((FourLong)one & made);
    cell[i] = start[i] + __builtin_convertvector(count, FourInt);
  }

  __attribute__((always_inline)) void find_places() {
    key = key_of(cell[0], cell[1], cell[2]);
    places = places_of(cell[0], cell[1], cell[2]) ^ mirrored;
  }
};

}  // namespace lapwing::brick_map
