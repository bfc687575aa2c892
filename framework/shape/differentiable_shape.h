// SPDX-License-Identifier: Apache-2.0
// The authoring layer of shapes: write the distance once, the kernel differentiates it.
//
//   class Ball final : public DifferentiableShape<Ball> {
//    public:
//     template <class T>
//     T core(const T* p) const { return ...; }  // core_distance of shape.h
//   };
//
// T is double or a dual number. Where the nearest part of a surface is chosen, it is chosen by
// value.
#pragma once

#include "framework/core/dual.h"
#include "framework/shape/shape.h"

namespace lapwing {

template <class Derived>
class DifferentiableShape : public Shape {
 public:
  double core_distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const final {
    if (!gradient) return self().core(p_W.data());
    using T = Dual<double, 3>;
    T p[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = T(p_W(i));
      p[i].d[i] = 1;
    }
    const T result = self().core(static_cast<const T*>(p));
    for (int i = 0; i < 3; ++i) (*gradient)(i) = result.d[i];
    return result.v;
  }

  Eigen::Matrix3d curvature(const Eigen::Vector3d& p_W) const final {
    using Inner = Dual<double, 3>;
    using T = Dual<Inner, 3>;
    T p[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = T(p_W(i));
      p[i].v.d[i] = 1;
      p[i].d[i] = Inner(1.0);
    }
    const T result = self().core(static_cast<const T*>(p));
    Eigen::Matrix3d second;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) second(i, j) = result.d[i].d[j];
    return second;
  }

 private:
  const Derived& self() const { return static_cast<const Derived&>(*this); }
};

}  // namespace lapwing
