// SPDX-License-Identifier: Apache-2.0
#include "plugins/maps/brick/voxel_update.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace lapwing::brick_map {

#if defined(__SSE2__)

namespace {

// All bits of lane k where bit k of `four` is set.
inline __m128i lanes_of(unsigned four) {
  const __m128i bits = _mm_set_epi32(8, 4, 2, 1);
  return _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(four)), bits), bits);
}

}  // namespace

std::uint64_t update_voxels(float values[64], std::uint64_t measured, std::uint64_t hit,
                            const MapSettings& settings) {
  const __m128 on_hit = _mm_set1_ps(settings.hit), on_miss = _mm_set1_ps(settings.miss);
  const __m128 least = _mm_set1_ps(settings.clamp_min), most = _mm_set1_ps(settings.clamp_max);
  const __m128 free_below = _mm_set1_ps(settings.free_below);
  std::uint64_t free = 0;
  for (int k = 0; k < 64; k += 4) {
    const unsigned four = measured >> k & 15;
    if (four == 0) continue;
    const __m128 touched = _mm_castsi128_ps(lanes_of(four));
    const __m128 struck = _mm_castsi128_ps(lanes_of(hit >> k & 15));
    const __m128 old = _mm_loadu_ps(values + k);
    const __m128 added = _mm_or_ps(_mm_and_ps(struck, on_hit), _mm_andnot_ps(struck, on_miss));
    const __m128 sum = _mm_min_ps(_mm_max_ps(_mm_add_ps(old, added), least), most);
    _mm_storeu_ps(values + k, _mm_or_ps(_mm_and_ps(touched, sum), _mm_andnot_ps(touched, old)));
    const auto is_free = static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(sum, free_below)));
    free |= static_cast<std::uint64_t>(is_free & four) << k;
  }
  return free;
}

#else

std::uint64_t update_voxels(float values[64], std::uint64_t measured, std::uint64_t hit,
                            const MapSettings& settings) {
  std::uint64_t free = 0;
  for (int k = 0; k < 64; ++k) {
    const std::uint64_t one = std::uint64_t{1} << k;
    if (!(measured & one)) continue;
    const float sum = values[k] + (hit & one ? settings.hit : settings.miss);
    values[k] = std::min(std::max(sum, settings.clamp_min), settings.clamp_max);
    if (values[k] < settings.free_below) free |= one;
  }
  return free;
}

#endif

}  // namespace lapwing::brick_map
