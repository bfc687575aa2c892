// SPDX-License-Identifier: Apache-2.0
// A distance and its derivatives at a point, carried through dual numbers: what formulas that are
// differentiated (problem/differentiable.h) read of a shape.
#pragma once

#include "framework/core/dual.h"
#include "framework/shape/shape.h"

namespace lapwing {

// The core distance of a shape at p, three numbers, with as many derivatives as T carries.
template <class T>
T lifted_core_distance(const Shape& shape, const T* p) {
  const Eigen::Vector3d at(value_of(p[0]), value_of(p[1]), value_of(p[2]));
  if constexpr (std::is_same_v<T, double>) {
    return shape.core_distance(at, nullptr);
  } else {
    using S = decltype(T{}.v);
    Eigen::Vector3d gradient;
    const double value = shape.core_distance(at, &gradient);
    T result;
    S slopes[3];
    if constexpr (std::is_same_v<S, double>) {
      result.v = value;
      for (int i = 0; i < 3; ++i) slopes[i] = gradient(i);
    } else {
      const Eigen::Matrix3d curvature = shape.curvature(at);
      result.v = S(value);
      for (int i = 0; i < 3; ++i) {
        slopes[i] = S(gradient(i));
        for (int j = 0; j < 3; ++j) slopes[i] += curvature(i, j) * (p[j].v - at(j));
        result.v += gradient(i) * (p[i].v - at(i));
      }
    }
    for (std::size_t k = 0; k < result.d.size(); ++k)
      result.d[k] = slopes[0] * p[0].d[k] + slopes[1] * p[1].d[k] + slopes[2] * p[2].d[k];
    return result;
  }
}

// From the surface.
template <class T>
T lifted_distance(const Shape& shape, const T* p) {
  return lifted_core_distance(shape, p) - shape.rounding();
}

}  // namespace lapwing
