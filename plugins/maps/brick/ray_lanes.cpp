// SPDX-License-Identifier: Apache-2.0
#include "plugins/maps/brick/ray_lanes.h"

namespace lapwing::brick_map {
namespace {

using Four = double __attribute__((vector_size(32)));
using FourLong = std::int64_t __attribute__((vector_size(32)));

struct Lanes {
  Four t[3], spacing[3], length;
  FourLong step[3], at, end;
};

__attribute__((always_inline)) inline void park(Lanes& lanes, int lane, std::int64_t parking) {
  for (int i = 0; i < 3; ++i) {
    lanes.t[i][lane] = lanes.spacing[i][lane] = 0;
    lanes.step[i][lane] = 0;
  }
  lanes.length[lane] = std::numeric_limits<double>::infinity();
  lanes.at[lane] = parking;
  lanes.end[lane] = -1;
}

// Takes the next ray that passes anything; false when there is none.
__attribute__((always_inline)) inline bool load(Lanes& lanes, int lane, const RayOrigin& origin,
                                                std::span<const Eigen::Vector3f> ends_W,
                                                std::size_t& next, const MarkTarget& target) {
  RayStart ray;
  while (next < ends_W.size()) {
    if (!origin.start(ends_W[next++], ray)) continue;
    lanes.length[lane] = ray.length;
    lanes.at[lane] = lanes.end[lane] = target.first;
    for (int i = 0; i < 3; ++i) {
      lanes.t[i][lane] = ray.t[i];
      lanes.spacing[i][lane] = ray.spacing[i];
      lanes.step[i][lane] = ray.step[i] * target.stride[i];
      lanes.end[lane] += (ray.end[i] - origin.cell()[i]) * target.stride[i];
    }
    return true;
  }
  park(lanes, lane, target.parking);
  return false;
}

template <bool kPages>
inline void mark(const MarkTarget& target, std::int64_t at) {
  __atomic_store_n(target.marks + at, kPassed, __ATOMIC_RELAXED);
  if constexpr (kPages) __atomic_store_n(target.pages + (at >> kPageShift), 1, __ATOMIC_RELAXED);
}

template <bool kPages>
__attribute__((always_inline)) inline void walk(const RayOrigin& origin,
                                                std::span<const Eigen::Vector3f> ends_W,
                                                const MarkTarget& target) {
  Lanes lanes;
  std::size_t next = 0;
  int busy = 0;
  for (int lane = 0; lane < 4; ++lane) busy += load(lanes, lane, origin, ends_W, next, target);
  while (busy > 0) {
    Four tx = lanes.t[0], ty = lanes.t[1], tz = lanes.t[2];
    FourLong at = lanes.at, done;
    while (true) {
      const FourLong xy = tx < ty, xz = tx < tz, yz = ty < tz;
      const FourLong mx = xy & xz, my = ~xy & yz, mz = ~(mx | my);
      at += (lanes.step[0] & mx) | (lanes.step[1] & my) | (lanes.step[2] & mz);
      tx += (Four)((FourLong)lanes.spacing[0] & mx);
      ty += (Four)((FourLong)lanes.spacing[1] & my);
      tz += (Four)((FourLong)lanes.spacing[2] & mz);
      const Four xy_least = tx < ty ? tx : ty;
      const Four least = xy_least < tz ? xy_least : tz;
      done = (at == lanes.end) | (least > lanes.length);
      if (done[0] | done[1] | done[2] | done[3]) break;
      for (int lane = 0; lane < 4; ++lane) mark<kPages>(target, at[lane]);
    }
    lanes.t[0] = tx, lanes.t[1] = ty, lanes.t[2] = tz, lanes.at = at;
    for (int lane = 0; lane < 4; ++lane) {
      if (!done[lane])
        mark<kPages>(target, at[lane]);
      else
        busy -= !load(lanes, lane, origin, ends_W, next, target);
    }
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void walk_avx2(const RayOrigin& origin,
                                               std::span<const Eigen::Vector3f> ends_W,
                                               const MarkTarget& target) {
  if (target.pages)
    walk<true>(origin, ends_W, target);
  else
    walk<false>(origin, ends_W, target);
}
#endif

}  // namespace

void mark_rays(const RayOrigin& origin, std::span<const Eigen::Vector3f> ends_W,
               const MarkTarget& target) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return walk_avx2(origin, ends_W, target);
#endif
  if (target.pages)
    walk<true>(origin, ends_W, target);
  else
    walk<false>(origin, ends_W, target);
}

}  // namespace lapwing::brick_map
