// SPDX-License-Identifier: Apache-2.0
// The arithmetic of the network: small dense products in single precision, and nothing else.
//
// Numbers of channels of results are multiples of 8 (kLanes). Where the processor has AVX2 or
// AVX-512 they are used; the order of additions depends neither on that nor on the number of
// threads.
#pragma once

#include <cstddef>

namespace lapwing::learned {

inline constexpr int kLanes = 8;

// c[i][j] = bias[j] + sum over parts p and k of a[p][i * stride + k] * b[p][k][j], for `rows` rows
// i and `columns` columns j; b is parts * depth rows of `columns` numbers; bias may be null. With
// `rectified` negative results become 0.
struct Product {
  const float* const* a = nullptr;
  int parts = 1;
  std::ptrdiff_t a_stride = 0;
  int depth = 0;
  const float* b = nullptr;
  const float* bias = nullptr;
  int rows = 0, columns = 0;
  float* c = nullptr;
  std::ptrdiff_t c_stride = 0;
  bool rectified = false;
};
void multiply(const Product& product);

// d[k][j] += sum over lines l and i of a[l][i * a_stride + k] * g[l][i * g_stride + j], for `depth`
// rows k and `columns` columns j, each line having `rows` rows i.
struct OuterProduct {
  const float* const* a = nullptr;
  const float* const* g = nullptr;
  int lines = 1, rows = 0;
  std::ptrdiff_t a_stride = 0, g_stride = 0;
  int depth = 0, columns = 0;
  float* d = nullptr;
};
void accumulate(const OuterProduct& product);

// A batch's normalisation of each of `maps` maps, with what follows it.
struct Normalisation {
  std::size_t maps = 0;  // a multiple of 8
  const float *mean = nullptr, *inverse = nullptr, *scale = nullptr, *shift = nullptr;
};
// Back through rectification: of `points` points (a multiple of 8) with values `y` before they were
// normalised, the gradient `g` becomes 0 where the result was not above 0. To `sums` it adds the
// gradient of each map's shift, then of each map's scale.
void back_through(const Normalisation& n, std::size_t points, const float* y, float* g,
                  double* sums);

}  // namespace lapwing::learned
