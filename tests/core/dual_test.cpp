// SPDX-License-Identifier: Apache-2.0
#include "framework/core/dual.h"

#include "framework/core/random.h"

namespace lapwing {
namespace {

using First = Dual<double, 2>;
using Second = Dual<Dual<double, 2>, 2>;
using std::abs, std::atan2, std::cos, std::exp, std::hypot, std::log, std::max, std::min, std::pow,
    std::sin, std::sqrt, std::tan;

struct Function {
  const char* name;
  double (*plain)(double, double);
  First (*first)(First, First);
  Second (*second)(Second, Second);
};

#define FUNCTION(formula)                                                                \
  Function {                                                                             \
#formula, [](double x, double y) { return double(formula); },                          \
        [](First x, First y) { return First(formula); },                                 \
        [](Second x, Second y) { return Second(formula); } \
  }

const Function kFunctions[] = {
    FUNCTION(x + y),
    FUNCTION(x - 3.0 * y),
    FUNCTION(x* y),
    FUNCTION(x / y),
    FUNCTION(2.0 / (x * y)),
    FUNCTION(-x* y* y),
    FUNCTION(sin(x* y)),
    FUNCTION(cos(x + y * y)),
    FUNCTION(tan(0.3 * x * y)),
    FUNCTION(exp(x - y)),
    FUNCTION(log(x* y)),
    FUNCTION(sqrt(x* x + y)),
    FUNCTION(abs(x - y)),
    FUNCTION(atan2(x, y)),
    FUNCTION(atan2(x - y, x* y)),
    FUNCTION(hypot(x, y)),
    FUNCTION(hypot(x - 2.0 * y, y* y)),
    FUNCTION(max(x* x, y)),
    FUNCTION(min(x* x, y)),
    FUNCTION(pow(x, 2.0) * pow(y, 3.0)),
    FUNCTION(pow(x* y, 1.7)),
    FUNCTION(pow(x* y, -0.5)),
    FUNCTION(pow(x, 1.0) * pow(y, 0.0)),
};

First seeded_first(double value, int k) {
  First x(value);
  x.d[k] = 1.0;
  return x;
}

Second seeded_second(double value, int k) {
  Second x(value);
  x.v.d[k] = 1.0;
  x.d[k] = Dual<double, 2>(1.0);
  return x;
}

// Fourth-order central difference of f along one argument.
template <class F>
double difference(F f, double at, double h) {
  return (8.0 * (f(at + h) - f(at - h)) - (f(at + 2 * h) - f(at - 2 * h))) / (12.0 * h);
}

TEST(Dual, DerivativesEqualDifferences) {
  Random random(3);
  for (const Function& f : kFunctions)
    for (int trial = 0; trial < 20; ++trial) {
      const double x = random.uniform(0.3, 2.0), y = random.uniform(0.3, 2.0);
      if (abs(x - y) < 0.02 || abs(x * x - y) < 0.02) continue;  // kinks
      SCOPED_TRACE(std::string(f.name) + " at " + std::to_string(x) + ", " + std::to_string(y));
      const First first = f.first(seeded_first(x, 0), seeded_first(y, 1));
      const Second second = f.second(seeded_second(x, 0), seeded_second(y, 1));
      EXPECT_DOUBLE_EQ(first.v, f.plain(x, y));
      EXPECT_DOUBLE_EQ(second.v.v, f.plain(x, y));
      const auto slope = [&](double a, double b, int k) {
        return f.first(seeded_first(a, 0), seeded_first(b, 1)).d[k];
      };
      EXPECT_NEAR(first.d[0], difference([&](double a) { return f.plain(a, y); }, x, 1e-3), 1e-7);
      EXPECT_NEAR(first.d[1], difference([&](double b) { return f.plain(x, b); }, y, 1e-3), 1e-7);
      for (int k = 0; k < 2; ++k) {
        EXPECT_DOUBLE_EQ(second.v.d[k], first.d[k]);
        const double scale = 1e-6 * (1.0 + abs(second.d[k].d[0]) + abs(second.d[k].d[1]));
        EXPECT_NEAR(second.d[k].d[0], difference([&](double a) { return slope(a, y, k); }, x, 1e-3),
                    scale);
        EXPECT_NEAR(second.d[k].d[1], difference([&](double b) { return slope(x, b, k); }, y, 1e-3),
                    scale);
      }
      EXPECT_NEAR(second.d[0].d[1], second.d[1].d[0], 1e-12 * (1 + abs(second.d[0].d[1])));
    }
}

void expect_finite(const Second& y) {
  EXPECT_TRUE(std::isfinite(y.v.v));
  for (int k = 0; k < 2; ++k) {
    EXPECT_TRUE(std::isfinite(y.v.d[k]));
    EXPECT_TRUE(std::isfinite(y.d[k].v));
    for (int j = 0; j < 2; ++j) EXPECT_TRUE(std::isfinite(y.d[k].d[j]));
  }
}

TEST(Dual, StaysFiniteAtKinks) {
  const Second zero = seeded_second(0.0, 0), other = seeded_second(0.0, 1);
  for (const Second& y :
       {sqrt(zero), sqrt(zero * zero + other * other), abs(zero), atan2(zero, other),
        hypot(zero, other), max(zero, other), min(zero, other), pow(zero, 2.0), pow(zero, 1.0),
        pow(zero, 0.0), pow(zero, 0.5), pow(zero, 1.5)})
    expect_finite(y);
  EXPECT_EQ(abs(zero).v.d[0], 0.0);
  EXPECT_EQ(sqrt(zero).v.d[0], 0.0);
  EXPECT_EQ(hypot(zero, other).v.d[0], 0.0);
  EXPECT_EQ(max(zero, other).v.d[0], 1.0) << "a tie takes the first";
  EXPECT_EQ(min(zero, other).v.d[0], 1.0) << "a tie takes the first";
  EXPECT_EQ(pow(zero, 2.0).d[0].d[0], 2.0);
}

TEST(Dual, CompoundAssignmentMayUseItself) {
  First x = seeded_first(3.0, 0);
  First square = x;
  square *= square;
  EXPECT_EQ(square.v, 9.0);
  EXPECT_EQ(square.d[0], 6.0);
  First one = x;
  one /= one;
  EXPECT_EQ(one.v, 1.0);
  EXPECT_EQ(one.d[0], 0.0);
  First none = x;
  none -= none;
  EXPECT_EQ(none.v, 0.0);
  EXPECT_EQ(none.d[0], 0.0);
}

TEST(Dual, ServesEigensSmallVectors) {
  Eigen::Matrix<First, 3, 1> a, b;
  for (int i = 0; i < 3; ++i) {
    a[i] = seeded_first(1.0 + i, 0);
    b[i] = seeded_first(2.0 - i, 1);
  }
  const First dot = a.dot(b), norm = a.norm();
  const Eigen::Matrix<First, 3, 1> cross = a.cross(b);
  EXPECT_DOUBLE_EQ(dot.v, 1 * 2 + 2 * 1 + 3 * 0);
  EXPECT_DOUBLE_EQ(dot.d[0], 2 + 1 + 0);
  EXPECT_DOUBLE_EQ(norm.d[0], 6.0 / std::sqrt(14.0));
  EXPECT_DOUBLE_EQ(cross.x().v, 2 * 0 - 3 * 1);
  const Eigen::Matrix<First, 3, 1> nothing = Eigen::Matrix<First, 3, 1>::Zero();
  EXPECT_EQ(nothing.norm().d[0], 0.0);
}

}  // namespace
}  // namespace lapwing
