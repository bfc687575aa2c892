// SPDX-License-Identifier: Apache-2.0
// Dual numbers of fixed size: forward-mode derivatives without allocation.
//
// Dual<S, N> is v + sum_k d[k] eps_k with eps_j eps_k = 0. With S = double it carries N first
// derivatives; with S = Dual<double, N> second ones. Comparisons look at the value alone. At kinks
// a subgradient is taken: abs'(0) = 0, min and max take the first argument on ties, and sqrt, norm,
// hypot, pow and atan2 have derivative 0 at 0 where they have none, so that a residual stays
// finite.
#pragma once

#include <array>
#include <cmath>

#include <Eigen/Core>

namespace lapwing {

template <class S, int N>
struct Dual {
  S v{};
  std::array<S, N> d{};

  Dual() = default;
  Dual(double value) : v(value) {}  // a constant; implicit, so that formulas read as written
  Dual(const S& value) requires(!std::is_same_v<S, double>) : v(value) {}

  // f(this) with f(v) = value and f'(v) = slope.
  Dual chain(const S& value, const S& slope) const {
    Dual r;
    r.v = value;
    for (int k = 0; k < N; ++k) r.d[k] = slope * d[k];
    return r;
  }

  Dual& operator+=(const Dual& o) {
    v += o.v;
    for (int k = 0; k < N; ++k) d[k] += o.d[k];
    return *this;
  }
  Dual& operator-=(const Dual& o) {
    v -= o.v;
    for (int k = 0; k < N; ++k) d[k] -= o.d[k];
    return *this;
  }
  Dual& operator*=(const Dual& o) {
    for (int k = 0; k < N; ++k) d[k] = d[k] * o.v + v * o.d[k];
    v *= o.v;
    return *this;
  }
  Dual& operator/=(const Dual& o) {
    const S inverse = S(1.0) / o.v;
    const S quotient = v / o.v;  // the very number that plain division gives
    for (int k = 0; k < N; ++k) d[k] = (d[k] - quotient * o.d[k]) * inverse;
    v = quotient;
    return *this;
  }
  Dual operator-() const { return chain(-v, S(-1.0)); }

  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend bool operator>(const Dual& a, const Dual& b) { return b.v < a.v; }
  friend bool operator<=(const Dual& a, const Dual& b) { return !(b.v < a.v); }
  friend bool operator>=(const Dual& a, const Dual& b) { return !(a.v < b.v); }
  friend bool operator==(const Dual& a, const Dual& b) { return a.v == b.v; }
};

inline double value_of(double x) {
  return x;
}
template <class S, int N>
double value_of(const Dual<S, N>& x) {
  return value_of(x.v);
}

template <class S, int N>
Dual<S, N> sin(const Dual<S, N>& x) {
  using std::cos, std::sin;
  return x.chain(sin(x.v), cos(x.v));
}
template <class S, int N>
Dual<S, N> cos(const Dual<S, N>& x) {
  using std::cos, std::sin;
  return x.chain(cos(x.v), -sin(x.v));
}
template <class S, int N>
Dual<S, N> tan(const Dual<S, N>& x) {
  using std::tan;
  const S t = tan(x.v);
  return x.chain(t, S(1.0) + t * t);
}
template <class S, int N>
Dual<S, N> exp(const Dual<S, N>& x) {
  using std::exp;
  const S e = exp(x.v);
  return x.chain(e, e);
}
template <class S, int N>
Dual<S, N> log(const Dual<S, N>& x) {
  using std::log;
  return x.chain(log(x.v), S(1.0) / x.v);
}
template <class S, int N>
Dual<S, N> sqrt(const Dual<S, N>& x) {
  using std::sqrt;
  if (value_of(x) == 0.0) return Dual<S, N>(0.0);
  const S root = sqrt(x.v);
  return x.chain(root, S(0.5) / root);
}
template <class S, int N>
Dual<S, N> abs(const Dual<S, N>& x) {
  using std::abs;
  const double value = value_of(x);
  return x.chain(abs(x.v), S(value > 0 ? 1.0 : value < 0 ? -1.0 : 0.0));
}
template <class S, int N>
Dual<S, N> atan2(const Dual<S, N>& y, const Dual<S, N>& x) {
  using std::atan2;
  Dual<S, N> r;
  r.v = atan2(y.v, x.v);
  const S squared = x.v * x.v + y.v * y.v;
  if (value_of(squared) == 0.0) return r;
  for (int k = 0; k < N; ++k) r.d[k] = (x.v * y.d[k] - y.v * x.d[k]) / squared;
  return r;
}
template <class S, int N>
Dual<S, N> min(const Dual<S, N>& a, const Dual<S, N>& b) {
  return b < a ? b : a;
}
template <class S, int N>
Dual<S, N> max(const Dual<S, N>& a, const Dual<S, N>& b) {
  return a < b ? b : a;
}
template <class S, int N>
Dual<S, N> hypot(const Dual<S, N>& x, const Dual<S, N>& y) {
  using std::hypot;
  Dual<S, N> r;
  r.v = hypot(x.v, y.v);
  if (value_of(r.v) == 0.0) return Dual<S, N>(0.0);
  const S a = x.v / r.v, b = y.v / r.v;
  for (int k = 0; k < N; ++k) r.d[k] = a * x.d[k] + b * y.d[k];
  return r;
}
// x^p for a constant p. Below p = 1 the derivative at 0 is taken as 0, as that of sqrt.
template <class S, int N>
Dual<S, N> pow(const Dual<S, N>& x, double p) {
  using std::pow;
  if (p == 0.0) return Dual<S, N>(1.0);
  if (p > 0.0 && p < 1.0 && value_of(x) == 0.0) return Dual<S, N>(0.0);
  return x.chain(pow(x.v, p), S(p) * pow(x.v, p - 1.0));
}

}  // namespace lapwing

// Lets Eigen's small fixed-size vectors hold duals: dot, cross, norm.
namespace Eigen {
template <class S, int N>
struct NumTraits<lapwing::Dual<S, N>> : NumTraits<double> {
  using Real = lapwing::Dual<S, N>;
  using NonInteger = lapwing::Dual<S, N>;
  using Nested = lapwing::Dual<S, N>;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = N,
    AddCost = N,
    MulCost = 2 * N
  };
};
}  // namespace Eigen
