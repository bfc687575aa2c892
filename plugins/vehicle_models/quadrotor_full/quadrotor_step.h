// SPDX-License-Identifier: Apache-2.0
// One step of the whole quadrotor, by Runge-Kutta 4, and what multipliers of it say of its
// arguments; for plain numbers and for duals.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/dual.h"
#include "framework/core/units.h"

namespace lapwing {

inline constexpr int kStates = 17, kInputs = 4, kArguments = kStates + kInputs + 1;
inline constexpr int kMoving = 3;  // the position moves nothing: no column for it
inline constexpr int kActive = kArguments - kMoving;  // numbers that the flow bends in
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Velocity, orientation, body rates: what the equations of motion are about.
template <class T>
struct Body {
  T v[3], q[4], w[3];
};
template <class T>
Body<T> moved(const Body<T>& from, const T& by, const Body<T>& along) {
  Body<T> result = from;
  for (int i = 0; i < 3; ++i) result.v[i] += by * along.v[i];
  for (int i = 0; i < 4; ++i) result.q[i] += by * along.q[i];
  for (int i = 0; i < 3; ++i) result.w[i] += by * along.w[i];
  return result;
}
template <class T>
void add(Body<T>& to, const T& by, const Body<T>& what) {
  to = moved(to, by, what);
}
template <class T>
T dot(const Body<T>& a, const Body<T>& b) {
  T sum = 0.0;
  for (int i = 0; i < 3; ++i) sum += a.v[i] * b.v[i] + a.w[i] * b.w[i];
  for (int i = 0; i < 4; ++i) sum += a.q[i] * b.q[i];
  return sum;
}

struct QuadrotorStep {
  double mass_ = 1, drag_ = 0, inertia_[3] = {1, 1, 1}, moment_[3][4] = {};

  template <class T>
  static void seed(const double* at, T* x) {
    for (int i = 0; i < kArguments; ++i) x[i] = T(at[i]);
    for (int i = 0; i < kActive; ++i) x[kMoving + i].d[i] = 1.0;
  }

  template <class T>
  Body<T> rates(const Body<T>& b, const T* f) const {
    Body<T> r;
    const T &qw = b.q[0], &qx = b.q[1], &qy = b.q[2], &qz = b.q[3];
    const T &wx = b.w[0], &wy = b.w[1], &wz = b.w[2];
    const T u = (f[0] + f[1] + f[2] + f[3]) * (1.0 / mass_);
    r.v[0] = 2.0 * (qx * qz + qw * qy) * u - drag_ * b.v[0];
    r.v[1] = 2.0 * (qy * qz - qw * qx) * u - drag_ * b.v[1];
    r.v[2] = (qw * qw - qx * qx - qy * qy + qz * qz) * u - drag_ * b.v[2] - kGravity;
    r.q[0] = -0.5 * (qx * wx + qy * wy + qz * wz);
    r.q[1] = 0.5 * (qw * wx + qy * wz - qz * wy);
    r.q[2] = 0.5 * (qw * wy + qz * wx - qx * wz);
    r.q[3] = 0.5 * (qw * wz + qx * wy - qy * wx);
    const T pairs[] = {wy * wz, wz * wx, wx * wy};
    for (int i = 0; i < 3; ++i) {
      r.w[i] = -gyration(i) * pairs[i];
      for (int k = 0; k < 4; ++k) r.w[i] += moment_[i][k] * f[k];
    }
    return r;
  }
  double gyration(int axis) const {
    return (inertia_[(axis + 2) % 3] - inertia_[(axis + 1) % 3]) / inertia_[axis];
  }

  // What multipliers `m` of the rates say of their arguments; that of the thrusts is added.
  template <class T>
  Body<T> rates_back(const Body<T>& b, const T* f, const Body<T>& m, T* thrusts) const {
    Body<T> r;
    const T &qw = b.q[0], &qx = b.q[1], &qy = b.q[2], &qz = b.q[3];
    const T &wx = b.w[0], &wy = b.w[1], &wz = b.w[2];
    const T u = (f[0] + f[1] + f[2] + f[3]) * (1.0 / mass_);
    const T up = (2.0 * (qx * qz + qw * qy) * m.v[0] + 2.0 * (qy * qz - qw * qx) * m.v[1] +
                  (qw * qw - qx * qx - qy * qy + qz * qz) * m.v[2]) *
                 (1.0 / mass_);
    const T s0 = 2.0 * u * m.v[0], s1 = 2.0 * u * m.v[1], s2 = 2.0 * u * m.v[2];
    for (int i = 0; i < 3; ++i) r.v[i] = -drag_ * m.v[i];
    const T &bw = m.q[0], &bx = m.q[1], &by = m.q[2], &bz = m.q[3];
    r.q[0] = qy * s0 - qx * s1 + qw * s2 + 0.5 * (bx * wx + by * wy + bz * wz);
    r.q[1] = qz * s0 - qw * s1 - qx * s2 + 0.5 * (bz * wy - bw * wx - by * wz);
    r.q[2] = qw * s0 + qz * s1 - qy * s2 + 0.5 * (bx * wz - bw * wy - bz * wx);
    r.q[3] = qx * s0 + qy * s1 + qz * s2 + 0.5 * (by * wx - bw * wz - bx * wy);
    r.w[0] = 0.5 * (bx * qw - bw * qx + by * qz - bz * qy);
    r.w[1] = 0.5 * (by * qw - bw * qy - bx * qz + bz * qx);
    r.w[2] = 0.5 * (bz * qw - bw * qz + bx * qy - by * qx);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      r.w[j] -= gyration(i) * b.w[k] * m.w[i];
      r.w[k] -= gyration(i) * b.w[j] * m.w[i];
    }
    for (int k = 0; k < 4; ++k) {
      thrusts[k] += up;
      for (int i = 0; i < 3; ++i) thrusts[k] += moment_[i][k] * m.w[i];
    }
    return r;
  }

  // The four places where a step asks for rates, and the rates.
  template <class T>
  struct Quarters {
    Body<T> at[4], rate[4];
    T thrusts[3][4];  // at the start, in the middle, at the end
    Body<T> sum;      // of the weighted rates
    Body<T> reached;  // before the orientation is made a unit
  };
  static constexpr int kWhen[4] = {0, 1, 1, 2};

  template <class T>
  void quarters(const T* x, Quarters<T>& s) const {
    const T& h = x[21];
    for (int k = 0; k < 4; ++k) {
      s.thrusts[0][k] = x[13 + k];
      s.thrusts[1][k] = x[13 + k] + 0.5 * h * x[17 + k];
      s.thrusts[2][k] = x[13 + k] + h * x[17 + k];
    }
    Body<T>& start = s.at[0];
    std::copy_n(x + 3, 3, start.v);
    std::copy_n(x + 6, 4, start.q);
    std::copy_n(x + 10, 3, start.w);
    const T half = 0.5 * h;
    for (int k = 0; k < 4; ++k) {
      if (k > 0) s.at[k] = moved(start, k == 3 ? h : half, s.rate[k - 1]);
      s.rate[k] = rates(s.at[k], s.thrusts[kWhen[k]]);
    }
    s.sum = s.rate[0];
    add(s.sum, T(2.0), s.rate[1]);
    add(s.sum, T(2.0), s.rate[2]);
    add(s.sum, T(1.0), s.rate[3]);
    s.reached = moved(start, h * (1.0 / 6), s.sum);
  }

  template <class T>
  static T length(const T* q) {
    using std::sqrt;
    return sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  }

  template <class T>
  void step(const T* x, T* next) const {
    Quarters<T> s;
    quarters(x, s);
    const T sixth = x[21] * (1.0 / 6);
    for (int i = 0; i < 3; ++i) {
      next[i] = x[i] + sixth * (s.at[0].v[i] + 2.0 * (s.at[1].v[i] + s.at[2].v[i]) + s.at[3].v[i]);
      next[3 + i] = s.reached.v[i];
      next[10 + i] = s.reached.w[i];
    }
    const T inverse = 1.0 / length(s.reached.q);
    for (int i = 0; i < 4; ++i) {
      next[6 + i] = s.reached.q[i] * inverse;
      next[13 + i] = s.thrusts[2][i];
    }
  }

  // The gradient of lambda . step with respect to x.
  template <class T>
  void pull_back(const T* x, const double* lambda, T* gradient) const {
    Quarters<T> s;
    quarters(x, s);
    const T &h = x[21], sixth = h * (1.0 / 6);
    T& of_h = gradient[21];
    Body<T> end;
    T unit[4], along = 0.0;
    const T inverse = 1.0 / length(s.reached.q);
    for (int i = 0; i < 4; ++i)
      unit[i] = s.reached.q[i] * inverse, along += unit[i] * lambda[6 + i];
    for (int i = 0; i < 4; ++i) end.q[i] = (lambda[6 + i] - unit[i] * along) * inverse;
    for (int i = 0; i < 3; ++i) end.v[i] = lambda[3 + i], end.w[i] = lambda[10 + i];
    of_h = dot(end, s.sum) * (1.0 / 6);
    T thrusts[3][4];
    for (auto& when : thrusts) std::fill_n(when, 4, T(0.0));
    for (int k = 0; k < 4; ++k) thrusts[2][k] = lambda[13 + k];
    Body<T> start = end;  // the start moves the end one to one
    Body<T> later;        // what the next place says of this one's rate
    for (int k = 3; k >= 0; --k) {
      const double share = k == 1 || k == 2 ? 2.0 : 1.0;
      Body<T> of_rate{};
      add(of_rate, share * sixth, end);
      if (k < 3) add(of_rate, k == 2 ? h : 0.5 * h, later);
      Body<T> of_place = rates_back(s.at[k], s.thrusts[kWhen[k]], of_rate, thrusts[kWhen[k]]);
      for (int i = 0; i < 3; ++i) {
        of_place.v[i] += share * sixth * lambda[i];
        of_h += (share / 6) * lambda[i] * s.at[k].v[i];
      }
      add(start, T(1.0), of_place);
      if (k > 0) of_h += (k == 3 ? 1.0 : 0.5) * dot(of_place, s.rate[k - 1]);
      later = of_place;
    }
    for (int i = 0; i < 3; ++i) gradient[i] = lambda[i];
    std::copy_n(start.v, 3, gradient + 3);
    std::copy_n(start.q, 4, gradient + 6);
    std::copy_n(start.w, 3, gradient + 10);
    for (int k = 0; k < 4; ++k) {
      gradient[13 + k] = thrusts[0][k] + thrusts[1][k] + thrusts[2][k];
      const T moving = 0.5 * thrusts[1][k] + thrusts[2][k];
      gradient[17 + k] = h * moving;
      of_h += x[17 + k] * moving;
    }
  }
};

// hessian [kArguments][kArguments] += the second derivatives of lambda . step at `at`.
void add_curvature(const QuadrotorStep& step, const double* at, const double* lambda,
                   double* hessian);

}  // namespace lapwing
