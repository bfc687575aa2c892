// SPDX-License-Identifier: Apache-2.0
// Derivatives by differences, and the judgement that is built on them: wrong entries are found
// whatever their size, and right ones pass whatever theirs.
#include "framework/conformance/differences.h"

#include <gtest/gtest.h>

#include "framework/core/random.h"

namespace lapwing {
namespace {

// Three functions of two numbers, smooth, of sizes that `scale` sets.
VectorFunction smooth(double scale) {
  return [=](const double* x, double* y) {
    y[0] = scale * (x[0] * x[0] * x[1] + std::sin(x[1]));
    y[1] = scale * std::exp(0.3 * x[0]);
    y[2] = scale * (5 * x[0] - 7 * x[1] + 1e3);
  };
}

RowMajorMatrix slopes(double scale, double a, double b) {
  RowMajorMatrix m(3, 2);
  m << 2 * a * b, a * a + std::cos(b), 0.3 * std::exp(0.3 * a), 0, 5, -7;
  return scale * m;
}

TEST(Differences, AreTheDerivativesOfSmoothFunctions) {
  for (const double a : {-3.0, 0.0, 0.2, 40.0}) {
    const Differences found = central_differences(smooth(1), {a, 1.7}, 3);
    const RowMajorMatrix truth = slopes(1, a, 1.7);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 2; ++c) {
        const double off = std::abs(found.value(r, c) - truth(r, c));
        EXPECT_LE(off, found.error(r, c) + 1e-9 * (1 + std::abs(truth(r, c)))) << r << c << a;
        EXPECT_LT(found.error(r, c), 1e-5 * (1 + truth.row(r).cwiseAbs().maxCoeff())) << r << c;
      }
  }
}

// Fourth order: exact but for rounding up to x^4, and what is left of x^5 is its h^4 term.
TEST(Differences, AreExactForPolynomialsOfTheFourthDegree) {
  const VectorFunction quartic = [](const double* x, double* y) {
    y[0] = x[0] * x[0] * x[0] * x[0] - 3 * x[0] * x[0] * x[0] + x[0];
  };
  const double x = 0.8, h = 0.05;  // in units of the usual step of 1e-4
  const Differences found = central_differences(quartic, {x}, 1, h / 1e-4);
  EXPECT_NEAR(found.value(0, 0), 4 * x * x * x - 9 * x * x + 1, 1e-12);
  const VectorFunction fifth = [](const double* at, double* y) { y[0] = std::pow(at[0], 5); };
  const Differences less = central_differences(fifth, {x}, 1, h / 1e-4);
  EXPECT_NEAR(less.value(0, 0) - 5 * std::pow(x, 4), -4 * std::pow(h / 2, 4), 1e-9);
}

TEST(Differences, RightDerivativesPassWhateverTheirSize) {
  for (const double scale : {1e-12, 1e-3, 1.0, 1e9})
    for (const double a : {0.0, 0.5, -20.0})
      EXPECT_LE(compare_derivatives(smooth(scale), {a, 0.4}, slopes(scale, a, 0.4), 1e-6).excess, 1)
          << scale << " at " << a;
}

TEST(Differences, AWrongEntryIsNamedWhateverItsSize) {
  for (const double scale : {1e-12, 1e-3, 1.0, 1e9})
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 2; ++c) {
        RowMajorMatrix stated = slopes(scale, 0.5, 0.4);
        stated(r, c) = r == 1 && c == 1 ? 1e-3 * scale : 1.001 * stated(r, c);
        const WorstEntry worst = compare_derivatives(smooth(scale), {0.5, 0.4}, stated, 1e-6);
        EXPECT_GT(worst.excess, 1) << scale << r << c;
        EXPECT_EQ(worst.row, r);
        EXPECT_EQ(worst.column, c);
        EXPECT_EQ(worst.stated, stated(r, c));
        EXPECT_NEAR(worst.expected, slopes(scale, 0.5, 0.4)(r, c), 1e-5 * scale);
      }
}

// An entry of 0.5 beside one of 1e6 is judged too.
TEST(Differences, ASmallEntryBesideALargeOneIsJudged) {
  const VectorFunction function = [](const double* x, double* y) {
    y[0] = 1e6 * x[0] + 0.5 * x[1];
  };
  RowMajorMatrix right(1, 2), wrong(1, 2);
  right << 1e6, 0.5;
  wrong << 1e6, 0.6;
  EXPECT_LE(compare_derivatives(function, {1, 1}, right, 1e-6).excess, 1);
  EXPECT_GT(compare_derivatives(function, {1, 1}, wrong, 1e-6).excess, 1);
}

// A kink as near as the first step is no error of a derivative that is right on its own side.
TEST(Differences, AKinkNearbyIsNoError) {
  const VectorFunction function = [](const double* x, double* y) { y[0] = std::abs(x[0]); };
  const RowMajorMatrix right = RowMajorMatrix::Constant(1, 1, 1);
  EXPECT_LE(compare_derivatives(function, {5e-5}, right, 1e-6).excess, 1);
  EXPECT_GT(compare_derivatives(function, {5e-5}, -right, 1e-6).excess, 1);
}

TEST(Differences, WhatIsNotFiniteIsWrong) {
  const VectorFunction function = [](const double* x, double* y) { y[0] = std::sqrt(x[0]); };
  const double nan = std::nan("");
  EXPECT_GT(compare_derivatives(function, {1.0}, RowMajorMatrix::Constant(1, 1, nan), 1).excess, 1);
  EXPECT_GT(compare_derivatives(function, {-1.0}, RowMajorMatrix::Constant(1, 1, 1), 1).excess, 1);
  EXPECT_GT(
      compare_derivatives(function, {1.0}, RowMajorMatrix::Constant(1, 1, HUGE_VAL), 1).excess, 1);
}

// The sieve lets no wrong entry of a thousandth through, and no right one fail.
TEST(Differences, TheSieveAlongADirection) {
  Random random(5);
  for (int turn = 0; turn < 40; ++turn) {
    const double a = random.uniform(-2, 2), b = random.uniform(-2, 2);
    std::vector<double> way;
    for (int c = 0; c < 2; ++c)
      way.push_back(random.uniform(0.5, 1) * (random.uniform() < 0.5 ? -1 : 1));
    RowMajorMatrix stated = slopes(1, a, b);
    EXPECT_TRUE(agrees_along(smooth(1), {a, b}, way, stated, 1e-6));
    const int r = static_cast<int>(random.integer(0, 2)),
              c = static_cast<int>(random.integer(0, 1));
    stated(r, c) += 1e-3 * (1 + std::abs(stated(r, c)));
    EXPECT_FALSE(agrees_along(smooth(1), {a, b}, way, stated, 1e-6)) << r << c;
  }
}

TEST(Differences, NumbersOfAnySizeAreToldApart) {
  EXPECT_EQ(text_of(-1.25e-8), "-1.25e-08");
  EXPECT_EQ(text_of(123456.7), "123456.7");
  EXPECT_NE(text_of(1.000001), text_of(1.000002));
  EXPECT_EQ(text_of(std::nan("")), "nan");
}

}  // namespace
}  // namespace lapwing
