// SPDX-License-Identifier: Apache-2.0
// Symbolic numbers give, compiled to a tape, what the same operations give on plain numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/problem/tape.h"
#include "framework/symbolic/symbolic_number.h"

namespace lapwing {
namespace {

using Formula = std::function<SymbolicScalar(SymbolicSetting*, const SymbolicEntries&)>;

double compiled(const Formula& formula, const std::vector<double>& x, double width = 0) {
  SymbolicSetting setting{.what = "cost 'tried'", .width = width, .serial = 1, .graph = {}};
  SymbolicEntries inputs;
  std::vector<int> places;
  for (std::size_t i = 0; i < x.size(); ++i) {
    places.push_back(static_cast<int>(i));
    inputs.push_back({.value = 0, .node = setting.graph.input(static_cast<int>(i))});
  }
  const int output = symbolic_node(setting, formula(&setting, inputs));
  const Tape tape(setting.graph, {output}, places, static_cast<int>(x.size()));
  double value = 0;
  Workspace workspace;
  tape.evaluate(1, x.data(), nullptr, &value, nullptr, workspace);
  return value;
}

double plain(const Formula& formula, const std::vector<double>& x) {
  SymbolicEntries inputs;
  for (const double value : x) inputs.push_back({.value = value});
  const SymbolicScalar result = formula(nullptr, inputs);
  EXPECT_TRUE(result.known());
  return result.value;
}

void expect_both(const Formula& formula, const std::vector<double>& x, double expected) {
  EXPECT_NEAR(compiled(formula, x), expected, 1e-12 * (1 + std::abs(expected)));
  EXPECT_NEAR(plain(formula, x), expected, 1e-12 * (1 + std::abs(expected)));
}

TEST(SymbolicNumber, PowersAreThoseOfTheLibrary) {
  for (const double p : {0.0, 1.0, 2.0, 3.0, 4.0, -1.0, 0.5, 1.7, -2.5, 7.0})
    for (const double base : {0.3, 1.0, 2.6})
      expect_both(
          [&](SymbolicSetting* setting, const SymbolicEntries& x) {
            return symbolic_power(setting, x[0], {.value = p});
          },
          {base}, std::pow(base, p));
  // Whole exponents take bases below 0.
  for (const double p : {2.0, 3.0, 4.0, -1.0})
    expect_both(
        [&](SymbolicSetting* setting, const SymbolicEntries& x) {
          return symbolic_power(setting, x[0], {.value = p});
        },
        {-1.5}, std::pow(-1.5, p));
}

TEST(SymbolicNumber, AnExponentThatVariesNeedsABaseAboveZero) {
  SymbolicSetting setting{.what = "cost 'tried'", .graph = {}};
  const SymbolicScalar exponent{.value = 0, .node = setting.graph.input(0)};
  EXPECT_THROW(symbolic_power(&setting, {.value = 0}, exponent), InputError);
  EXPECT_THROW(symbolic_power(&setting, {.value = -2}, exponent), InputError);
  EXPECT_NEAR(
      compiled([](SymbolicSetting* s,
                  const SymbolicEntries& x) { return symbolic_power(s, {.value = 2}, x[0]); },
               {1.5}),
      std::pow(2, 1.5), 1e-12);
}

TEST(SymbolicNumber, ExtremesOfAnyNumberOfValues) {
  const std::vector<double> x{0.3, -4, 2.5, 1};
  for (const bool largest : {true, false})
    expect_both([&](SymbolicSetting* setting,
                    const SymbolicEntries& of) { return symbolic_extreme(setting, of, largest); },
                x, largest ? 2.5 : -4);
}

TEST(SymbolicNumber, ExtremesAreRoundedWithinTheWidth) {
  const Formula largest = [](SymbolicSetting* setting, const SymbolicEntries& of) {
    return symbolic_extreme(setting, of, true);
  };
  // max = (a + b + |a - b|) / 2, and |0| is rounded to 3/8 of the width (tape_operation.h).
  EXPECT_NEAR(compiled(largest, {1, 1}, 0.2), 1 + 0.375 * 0.2 / 2, 1e-12);
  EXPECT_NEAR(compiled(largest, {1, 1.3}, 0.2), 1.3, 1e-12);
}

TEST(SymbolicNumber, AChoiceGoesByTheSign) {
  const Formula choice = [](SymbolicSetting* setting, const SymbolicEntries& x) {
    return symbolic_choice(setting, x[0], x[1], x[2]);
  };
  expect_both(choice, {0.1, 5, 7}, 5);
  expect_both(choice, {0, 5, 7}, 7);
  expect_both(choice, {-3, 5, 7}, 7);
}

TEST(SymbolicNumber, ProductsOfVectorsAreThoseOfEigen) {
  Random random(4);
  for (int k = 0; k < 5; ++k) {
    std::vector<double> x(6);
    for (double& value : x) value = random.uniform(-3, 3);
    const Eigen::Vector3d a(x[0], x[1], x[2]), b(x[3], x[4], x[5]);
    const auto first = [](const SymbolicEntries& of) {
      return SymbolicEntries(of.begin(), of.begin() + 3);
    };
    const auto second = [](const SymbolicEntries& of) {
      return SymbolicEntries(of.begin() + 3, of.end());
    };
    expect_both([&](SymbolicSetting* s,
                    const SymbolicEntries& of) { return symbolic_dot(s, first(of), second(of)); },
                x, a.dot(b));
    for (int i = 0; i < 3; ++i)
      expect_both(
          [&](SymbolicSetting* s, const SymbolicEntries& of) {
            return symbolic_cross(s, first(of), second(of))[static_cast<std::size_t>(i)];
          },
          x, a.cross(b)(i));
    expect_both([&](SymbolicSetting* s,
                    const SymbolicEntries& of) { return symbolic_length(s, first(of)); },
                x, a.norm());
  }
}

TEST(SymbolicNumber, WhatIsKnownIsNoNode) {
  SymbolicSetting setting{.what = "cost 'tried'", .graph = {}};
  const SymbolicScalar x{.value = 0, .node = setting.graph.input(0)};
  const SymbolicScalar zero = symbolic_product(&setting, x, {.value = 0});
  ASSERT_TRUE(zero.known());
  EXPECT_EQ(zero.value, 0);
  EXPECT_EQ(symbolic_product(&setting, x, {.value = 1}).node, x.node);
  EXPECT_EQ(symbolic_result(nullptr, TapeOp::add, {.value = 2}, {.value = 3}).value, 5);
}

}  // namespace
}  // namespace lapwing
