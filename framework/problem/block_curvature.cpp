// SPDX-License-Identifier: Apache-2.0
// Second derivatives of the difference of two orientations, by dual numbers.
#include "framework/core/dual.h"
#include "framework/core/error.h"
#include "framework/problem/block.h"

namespace lapwing {
namespace {

template <class T>
struct Quaternion {
  T w, x, y, z;
};

template <class T>
Quaternion<T> product(const Quaternion<T>& a, const Quaternion<T>& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z, a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x};
}

// exp of a rotation vector, right to second order at 0, which is where it is differentiated.
template <class T>
Quaternion<T> small_rotation(const T* rotation, double sign) {
  const T half[] = {0.5 * sign * rotation[0], 0.5 * sign * rotation[1], 0.5 * sign * rotation[2]};
  const T squared = half[0] * half[0] + half[1] * half[1] + half[2] * half[2];
  return {1.0 - 0.5 * squared, half[0], half[1], half[2]};
}

// angle / |vector part|, smooth at the identity; w must not be negative.
template <class T>
T angle_ratio(const Quaternion<T>& q) {
  const T squared = q.x * q.x + q.y * q.y + q.z * q.z;
  if (value_of(squared) < 1e-6) {
    const T s = squared / (q.w * q.w);
    return 2.0 / q.w * (1.0 - s * (1.0 / 3.0 - s * (1.0 / 5.0 - s * (1.0 / 7.0))));
  }
  const T sine = sqrt(squared);
  return 2.0 * atan2(sine, q.w) / sine;
}

}  // namespace

Eigen::MatrixXd difference_curvature(const BlockSpec& block, const double* from, const double* to,
                                     const double* multipliers) {
  const int n = 2 * block.tangent_size();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  if (block.topology == Topology::line) return result;
  using T = Dual<Dual<double, 6>, 6>;
  std::array<T, 6> steps;
  for (int k = 0; k < 6; ++k) {
    steps[k].v.d[k] = 1.0;
    steps[k].d[k] = Dual<double, 6>(1.0);
  }
  const Quaternion<T> p{from[0], -from[1], -from[2], -from[3]}, q{to[0], to[1], to[2], to[3]};
  Quaternion<T> e = product(product(small_rotation(steps.data(), -1.0), p),
                            product(q, small_rotation(steps.data() + 3, 1.0)));
  if (value_of(e.w) < 0) e = {-e.w, -e.x, -e.y, -e.z};  // q and -q are one rotation
  const T ratio = angle_ratio(e);
  const T sum = ratio * (multipliers[0] * e.x + multipliers[1] * e.y + multipliers[2] * e.z);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) result(i, j) = sum.d[i].d[j];
  return result;
}

}  // namespace lapwing
