#include "plugins/utilities/learned/kernels.h"

#include <cstring>

namespace lapwing::learned {
namespace {

#define LAPWING_INLINE inline __attribute__((always_inline))

typedef float Lanes __attribute__((vector_size(4 * kLanes)));
typedef float LooseLanes __attribute__((vector_size(4 * kLanes), aligned(4)));

#define LOAD(from) (*reinterpret_cast<const LooseLanes*>(from))
#define STORE(to, what) (*reinterpret_cast<LooseLanes*>(to) = (what))

// R rows and V times 8 columns of the result at once, in registers.
template <int R, int V>
LAPWING_INLINE void multiply_tile(const Product& p, int row, int column) {
  Lanes sum[R][V];
  for (int v = 0; v < V; ++v) {
    Lanes first = {};
    if (p.bias) first = LOAD(p.bias + column + v * kLanes);
    for (int r = 0; r < R; ++r) sum[r][v] = first;
  }
  const float* b = p.b + column;
  for (int part = 0; part < p.parts; ++part) {
    const float* a = p.a[part] + row * p.a_stride;
    for (int k = 0; k < p.depth; ++k, b += p.columns) {
      Lanes w[V];
      for (int v = 0; v < V; ++v) w[v] = LOAD(b + v * kLanes);
      for (int r = 0; r < R; ++r) {
        const float x = a[r * p.a_stride + k];
        for (int v = 0; v < V; ++v) sum[r][v] += x * w[v];
      }
    }
  }
  for (int r = 0; r < R; ++r)
    for (int v = 0; v < V; ++v) {
      if (p.rectified) sum[r][v] = sum[r][v] > 0 ? sum[r][v] : Lanes{};
      STORE(p.c + (row + r) * p.c_stride + column + v * kLanes, sum[r][v]);
    }
}

// Eight sums or more are under way at any time, so that none waits for the one before.
LAPWING_INLINE void multiply_any(const Product& p) {
  int column = 0;
  for (; column + kLanes <= p.columns;) {
    const int left = p.columns - column;
    int row = 0;
    if (left == kLanes) {
      for (; row + 8 <= p.rows; row += 8) multiply_tile<8, 1>(p, row, column);
      for (; row < p.rows; ++row) multiply_tile<1, 1>(p, row, column);
      column += kLanes;
    } else if (left == 3 * kLanes) {
      for (; row + 4 <= p.rows; row += 4) multiply_tile<4, 3>(p, row, column);
      for (; row < p.rows; ++row) multiply_tile<1, 3>(p, row, column);
      column += 3 * kLanes;
    } else {
      for (; row + 4 <= p.rows; row += 4) multiply_tile<4, 2>(p, row, column);
      for (; row < p.rows; ++row) multiply_tile<1, 2>(p, row, column);
      column += 2 * kLanes;
    }
  }
}

template <int K, int V>
LAPWING_INLINE void outer_tile(const OuterProduct& p, int k, int column) {
  Lanes sum[K][V];
  for (int i = 0; i < K; ++i)
    for (int v = 0; v < V; ++v) sum[i][v] = LOAD(p.d + (k + i) * p.columns + column + v * kLanes);
  for (int line = 0; line < p.lines; ++line) {
    const float* a = p.a[line] + k;
    const float* g = p.g[line] + column;
    for (int row = 0; row < p.rows; ++row, a += p.a_stride, g += p.g_stride) {
      Lanes w[V];
      for (int v = 0; v < V; ++v) w[v] = LOAD(g + v * kLanes);
      for (int i = 0; i < K; ++i)
        for (int v = 0; v < V; ++v) sum[i][v] += a[i] * w[v];
    }
  }
  for (int i = 0; i < K; ++i)
    for (int v = 0; v < V; ++v) STORE(p.d + (k + i) * p.columns + column + v * kLanes, sum[i][v]);
}

template <int K>
LAPWING_INLINE void outer_rows(const OuterProduct& p, int k) {
  int column = 0;
  for (; column + 2 * kLanes <= p.columns; column += 2 * kLanes) outer_tile<K, 2>(p, k, column);
  for (; column < p.columns; column += kLanes) outer_tile<K, 1>(p, k, column);
}

LAPWING_INLINE void accumulate_any(const OuterProduct& p) {
  int k = 0;
  for (; k + 4 <= p.depth; k += 4) outer_rows<4>(p, k);
  for (; k < p.depth; ++k) outer_rows<1>(p, k);
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void multiply_avx2(const Product& p) {
  multiply_any(p);
}
__attribute__((target("avx2,fma"))) void accumulate_avx2(const OuterProduct& p) {
  accumulate_any(p);
}
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
}
#endif

}  // namespace

void multiply(const Product& product) {
#if defined(__x86_64__)
  if (has_avx2()) return multiply_avx2(product);
#endif
  multiply_any(product);
}

void accumulate(const OuterProduct& product) {
#if defined(__x86_64__)
  if (has_avx2()) return accumulate_avx2(product);
#endif
  accumulate_any(product);
}

}  // namespace lapwing::learned
