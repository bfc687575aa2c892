// SPDX-License-Identifier: Apache-2.0
// Numbers and vectors that a term computes with while it is recorded: nodes of an expression, or
// plain numbers. Operations on plain numbers are carried out at once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/problem/expression_graph.h"

namespace lapwing {

// A number: known, or a node of the recording under way.
struct SymbolicScalar {
  double value = 0;
  int node = -1;
  bool known() const { return node < 0; }
};
using SymbolicEntries = std::vector<SymbolicScalar>;

// The recording under way. Values are worth nothing in another one: `serial` tells them apart.
struct SymbolicSetting {
  std::string what;  // "cost 'keep_low'", for messages
  double width = 0;  // within which kinks are rounded
  std::uint64_t serial = 0;
  ExpressionGraph graph;
};

// In all that follows `setting` may be null where every operand is known; kinks are exact then.

// An operation; carried out at once where all operands are known. InputError beyond a million
// nodes.
SymbolicScalar symbolic_result(SymbolicSetting* setting, TapeOp op, const SymbolicScalar& a,
                               const SymbolicScalar& b = {}, const SymbolicScalar& c = {},
                               double number = 0, int data = 0);
// The node of a number, known or not.
int symbolic_node(SymbolicSetting& setting, const SymbolicScalar& scalar);
// The number that a node is: known where the node is a constant.
SymbolicScalar symbolic_of_node(const SymbolicSetting& setting, int node);

SymbolicScalar symbolic_product(SymbolicSetting* setting, const SymbolicScalar& a,
                                const SymbolicScalar& b);
// Small whole exponents become products. InputError where the exponent is not known and the base is
// known to be 0 or less.
SymbolicScalar symbolic_power(SymbolicSetting* setting, const SymbolicScalar& base,
                              const SymbolicScalar& exponent);
// The largest or the smallest of at least one, rounded where two meet.
SymbolicScalar symbolic_extreme(SymbolicSetting* setting, const SymbolicEntries& of, bool largest);
// a where choice > 0, b elsewhere.
SymbolicScalar symbolic_choice(SymbolicSetting* setting, const SymbolicScalar& choice,
                               const SymbolicScalar& a, const SymbolicScalar& b);
// Of vectors of one size.
SymbolicScalar symbolic_dot(SymbolicSetting* setting, const SymbolicEntries& a,
                            const SymbolicEntries& b);
// Of vectors of three numbers.
SymbolicEntries symbolic_cross(SymbolicSetting* setting, const SymbolicEntries& a,
                               const SymbolicEntries& b);
// The length of a vector, rounded at 0.
SymbolicScalar symbolic_length(SymbolicSetting* setting, const SymbolicEntries& v);

}  // namespace lapwing
