// SPDX-License-Identifier: Apache-2.0
#include "plugins/utilities/learned/kernels.h"

#include <cstring>
#include <type_traits>

namespace lapwing::learned {
namespace {

#define LAPWING_INLINE inline __attribute__((always_inline))

// So many numbers at once. A column's sum is made in the same order whichever it belongs to.
typedef float Lanes8 __attribute__((vector_size(32)));
typedef float Lanes16 __attribute__((vector_size(64)));
typedef double Doubles8 __attribute__((vector_size(64)));
template <int L>
using Vector = std::conditional_t<L == 16, Lanes16, Lanes8>;

// From and to anywhere in memory.
template <class Lanes, class Number>
LAPWING_INLINE void load(Lanes& lanes, const Number* from) {
  std::memcpy(&lanes, from, sizeof lanes);
}
template <class Lanes, class Number>
LAPWING_INLINE void store(Number* to, const Lanes& lanes) {
  std::memcpy(to, &lanes, sizeof lanes);
}

// R rows and V times L columns of the result at once, in registers.
template <int L, int R, int V>
LAPWING_INLINE void multiply_tile(const Product& p, int row, int column) {
  using Lanes = Vector<L>;
  Lanes sum[R][V];
  for (int v = 0; v < V; ++v) {
    Lanes first = {};
    if (p.bias) load(first, p.bias + column + v * L);
    for (int r = 0; r < R; ++r) sum[r][v] = first;
  }
  const float* b = p.b + column;
  for (int part = 0; part < p.parts; ++part) {
    const float* a = p.a[part] + row * p.a_stride;
    for (int k = 0; k < p.depth; ++k, b += p.columns) {
      Lanes w[V];
      for (int v = 0; v < V; ++v) load(w[v], b + v * L);
      for (int r = 0; r < R; ++r) {
        const float x = a[r * p.a_stride + k];
        for (int v = 0; v < V; ++v) sum[r][v] += x * w[v];
      }
    }
  }
  for (int r = 0; r < R; ++r)
    for (int v = 0; v < V; ++v) {
      if (p.rectified) sum[r][v] = sum[r][v] > 0 ? sum[r][v] : Lanes{};
      store(p.c + (row + r) * p.c_stride + column + v * L, sum[r][v]);
    }
}

// Eight sums or more are under way at any time, so that none waits for the one before.
template <int L, int R, int V>
LAPWING_INLINE void multiply_columns(const Product& p, int column) {
  int row = 0;
  for (; row + R <= p.rows; row += R) multiply_tile<L, R, V>(p, row, column);
  for (; row < p.rows; ++row) multiply_tile<L, 1, V>(p, row, column);
}

// As much as possible with vectors of 16, where the processor has them; the rest with 8.
template <bool has16>
LAPWING_INLINE void multiply_any(const Product& p) {
  int column = 0;
  if constexpr (has16) {
    for (; column + 32 <= p.columns; column += 32) multiply_columns<16, 8, 2>(p, column);
    for (; column + 16 <= p.columns; column += 16) multiply_columns<16, 8, 1>(p, column);
  } else {
    for (; column + 16 <= p.columns && p.columns - column != 24; column += 16)
      multiply_columns<8, 4, 2>(p, column);
    if (p.columns - column == 24) return multiply_columns<8, 4, 3>(p, column);
  }
  for (; column + 8 <= p.columns; column += 8) multiply_columns<8, 8, 1>(p, column);
}

template <int L, int K, int V>
LAPWING_INLINE void outer_tile(const OuterProduct& p, int k, int column) {
  using Lanes = Vector<L>;
  Lanes sum[K][V];
  for (int i = 0; i < K; ++i)
    for (int v = 0; v < V; ++v) load(sum[i][v], p.d + (k + i) * p.columns + column + v * L);
  for (int line = 0; line < p.lines; ++line) {
    const float* a = p.a[line] + k;
    const float* g = p.g[line] + column;
    for (int row = 0; row < p.rows; ++row, a += p.a_stride, g += p.g_stride) {
      Lanes w[V];
      for (int v = 0; v < V; ++v) load(w[v], g + v * L);
      for (int i = 0; i < K; ++i)
        for (int v = 0; v < V; ++v) sum[i][v] += a[i] * w[v];
    }
  }
  for (int i = 0; i < K; ++i)
    for (int v = 0; v < V; ++v) store(p.d + (k + i) * p.columns + column + v * L, sum[i][v]);
}

template <int L, int K, int V>
LAPWING_INLINE void outer_columns(const OuterProduct& p, int column) {
  int k = 0;
  for (; k + K <= p.depth; k += K) outer_tile<L, K, V>(p, k, column);
  for (; k + 2 <= p.depth; k += 2) outer_tile<L, 2, V>(p, k, column);
  for (; k < p.depth; ++k) outer_tile<L, 1, V>(p, k, column);
}

template <bool has16>
LAPWING_INLINE void accumulate_any(const OuterProduct& p) {
  int column = 0;
  if constexpr (has16) {
    for (; column + 32 <= p.columns; column += 32) outer_columns<16, 8, 2>(p, column);
    for (; column + 16 <= p.columns; column += 16) outer_columns<16, 8, 1>(p, column);
  } else {
    for (; column + 16 <= p.columns; column += 16) outer_columns<8, 4, 2>(p, column);
  }
  for (; column + 8 <= p.columns; column += 8) outer_columns<8, 8, 1>(p, column);
}

constexpr std::size_t kTogether = 8;  // points whose sum is made in single precision

LAPWING_INLINE void back_through_any(const Normalisation& n, std::size_t points, const float* y,
                                     float* g, double* sums) {
  for (std::size_t p = 0; p < points; p += kTogether)
    for (std::size_t c = 0; c < n.maps; c += 8) {
      Lanes8 mean, inverse, scale, shift, sum = {}, weighted = {};
      load(mean, n.mean + c);
      load(inverse, n.inverse + c);
      load(scale, n.scale + c);
      load(shift, n.shift + c);
      for (std::size_t q = p; q < p + kTogether; ++q) {
        Lanes8 value, kept;
        load(value, y + q * n.maps + c);
        load(kept, g + q * n.maps + c);
        const Lanes8 normal = (value - mean) * inverse;
        kept = scale * normal + shift > 0 ? kept : Lanes8{};
        store(g + q * n.maps + c, kept);
        sum += kept;
        weighted += kept * normal;
      }
      Doubles8 total, total_weighted;
      load(total, sums + c);
      load(total_weighted, sums + n.maps + c);
      store(sums + c, total + __builtin_convertvector(sum, Doubles8));
      store(sums + n.maps + c, total_weighted + __builtin_convertvector(weighted, Doubles8));
    }
}

#if defined(__x86_64__)
#define LAPWING_AVX2 __attribute__((target("avx2,fma")))
#define LAPWING_AVX512 __attribute__((target("avx2,fma,avx512f,avx512vl,prefer-vector-width=512")))
LAPWING_AVX2 void multiply_avx2(const Product& p) {
  multiply_any<false>(p);
}
LAPWING_AVX2 void accumulate_avx2(const OuterProduct& p) {
  accumulate_any<false>(p);
}
LAPWING_AVX2 void back_through_avx2(const Normalisation& n, std::size_t points, const float* y,
                                    float* g, double* sums) {
  back_through_any(n, points, y, g, sums);
}
LAPWING_AVX512 void multiply_avx512(const Product& p) {
  multiply_any<true>(p);
}
LAPWING_AVX512 void accumulate_avx512(const OuterProduct& p) {
  accumulate_any<true>(p);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
}
bool has_avx512() {
  static const bool has =
      has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
  return has;
}
#endif

}  // namespace

void multiply(const Product& product) {
#if defined(__x86_64__)
  if (has_avx512()) return multiply_avx512(product);
  if (has_avx2()) return multiply_avx2(product);
#endif
  multiply_any<false>(product);
}

void accumulate(const OuterProduct& product) {
#if defined(__x86_64__)
  if (has_avx512()) return accumulate_avx512(product);
  if (has_avx2()) return accumulate_avx2(product);
#endif
  accumulate_any<false>(product);
}

void back_through(const Normalisation& n, std::size_t points, const float* y, float* g,
                  double* sums) {
#if defined(__x86_64__)
  if (has_avx2()) return back_through_avx2(n, points, y, g, sums);
#endif
  back_through_any(n, points, y, g, sums);
}

}  // namespace lapwing::learned
