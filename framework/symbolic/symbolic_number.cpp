// SPDX-License-Identifier: Apache-2.0
#include "framework/symbolic/symbolic_number.h"

#include "framework/core/error.h"

namespace lapwing {

namespace {

double rounding(const SymbolicSetting* setting) {
  return setting ? setting->width : 0.0;
}

}  // namespace

int symbolic_node(SymbolicSetting& setting, const SymbolicScalar& scalar) {
  return scalar.known() ? setting.graph.constant(scalar.value) : scalar.node;
}

SymbolicScalar symbolic_of_node(const SymbolicSetting& setting, int node) {
  if (setting.graph.is_constant(node)) return {.value = setting.graph.number(node)};
  return {.value = 0, .node = node};
}

SymbolicScalar symbolic_result(SymbolicSetting* setting, TapeOp op, const SymbolicScalar& a,
                               const SymbolicScalar& b, const SymbolicScalar& c, double number,
                               int data) {
  if (a.known() && b.known() && c.known()) {
    const double x[] = {a.value, b.value, c.value};
    return {.value = local_value({op, data, number}, x, {}, 0).value};
  }
  const int count = operand_count(op);
  const int nodes[] = {symbolic_node(*setting, a), count > 1 ? symbolic_node(*setting, b) : -1,
                       count > 2 ? symbolic_node(*setting, c) : -1};
  return symbolic_of_node(*setting,
                          setting->graph.apply(op, nodes[0], nodes[1], nodes[2], number, data));
}

SymbolicScalar symbolic_product(SymbolicSetting* setting, const SymbolicScalar& a,
                                const SymbolicScalar& b) {
  return symbolic_result(setting, TapeOp::multiply, a, b);
}

SymbolicScalar symbolic_power(SymbolicSetting* setting, const SymbolicScalar& base,
                              const SymbolicScalar& exponent) {
  if (!exponent.known()) {
    if (base.known() && !(base.value > 0))
      throw InputError("'^' with an exponent that varies: the base must be above 0");
    const SymbolicScalar log = symbolic_result(setting, TapeOp::log, base);
    return symbolic_result(setting, TapeOp::exp, symbolic_product(setting, exponent, log));
  }
  const double p = exponent.value;
  if (p == 0) return {.value = 1};
  if (p == 1) return base;
  if (p == 2) return symbolic_product(setting, base, base);
  if (p == 3) return symbolic_product(setting, symbolic_product(setting, base, base), base);
  if (p == 4) {
    const SymbolicScalar square = symbolic_product(setting, base, base);
    return symbolic_product(setting, square, square);
  }
  if (p == -1) return symbolic_result(setting, TapeOp::divide, {.value = 1}, base);
  if (p == 0.5) return symbolic_result(setting, TapeOp::sqrt, base);
  return symbolic_result(setting, TapeOp::power, base, {}, {}, p);
}

SymbolicScalar symbolic_extreme(SymbolicSetting* setting, const SymbolicEntries& of, bool largest) {
  const auto turned = [&](const SymbolicScalar& x) {
    return largest ? x : symbolic_result(setting, TapeOp::negate, x);
  };
  SymbolicScalar result = turned(of[0]);
  for (std::size_t i = 1; i < of.size(); ++i)
    result =
        symbolic_result(setting, TapeOp::maximum, result, turned(of[i]), {}, rounding(setting));
  return turned(result);
}

SymbolicScalar symbolic_choice(SymbolicSetting* setting, const SymbolicScalar& choice,
                               const SymbolicScalar& a, const SymbolicScalar& b) {
  if (choice.known()) return choice.value > 0 ? a : b;
  return symbolic_result(setting, TapeOp::select, choice, a, b);
}

SymbolicScalar symbolic_dot(SymbolicSetting* setting, const SymbolicEntries& a,
                            const SymbolicEntries& b) {
  SymbolicScalar sum = symbolic_product(setting, a[0], b[0]);
  for (std::size_t i = 1; i < a.size(); ++i)
    sum = symbolic_result(setting, TapeOp::add, sum, symbolic_product(setting, a[i], b[i]));
  return sum;
}

SymbolicEntries symbolic_cross(SymbolicSetting* setting, const SymbolicEntries& a,
                               const SymbolicEntries& b) {
  SymbolicEntries result(3);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    result[i] = symbolic_result(setting, TapeOp::subtract, symbolic_product(setting, a[j], b[k]),
                                symbolic_product(setting, a[k], b[j]));
  }
  return result;
}

SymbolicScalar symbolic_length(SymbolicSetting* setting, const SymbolicEntries& v) {
  return symbolic_result(setting, TapeOp::norm, symbolic_dot(setting, v, v), {}, {},
                         rounding(setting));
}

}  // namespace lapwing
