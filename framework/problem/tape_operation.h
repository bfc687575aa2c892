// SPDX-License-Identifier: Apache-2.0
// The operations of a tape (tape.h): what each gives, and its derivatives.
//
// Kinks are rounded within a width w that every such operation carries, and exact outside of it:
//
//   |x|, and max(a, b) by |a - b|:   w (3/8 + 3/4 t^2 - 1/8 t^4),   t = x / w, within |t| < 1
//   norm, the root of a sum of squares: the same with t^2 = s / w^2
//
// which is twice differentiable, at most 3/8 w too large, and straight behind at |t| = 1. With w =
// 0 they are exact and have the subgradients of dual.h. sqrt has derivative 0 at 0; select is a
// choice by the sign of its first operand and is not rounded.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "framework/geometry/distance_field.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

enum class TapeOp : std::uint8_t {
  constant,   // number
  input,      // data: which one
  parameter,  // data: which one
  add,
  subtract,
  multiply,
  divide,
  negate,
  sin,
  cos,
  tan,
  exp,
  log,
  sqrt,
  power,     // a ^ number
  atan2,     // y, x
  absolute,  // number: the width
  norm,      // root of the sum of squares a; number: the width
  maximum,   // number: the width
  select,    // b where a > 0, else c
  track,     // of subject data / 3, component data % 3, at time a
  distance,  // field data, at (a, b, c)
};

// 0 for constants, inputs and parameters.
int operand_count(TapeOp op);

// What operations read that is no number. Immutable once a tape holds it.
struct TapeSources {
  std::vector<Subject> subjects;
  std::vector<std::shared_ptr<const DistanceField>> fields;
};

// An operation without its operands.
struct TapeCall {
  TapeOp op = TapeOp::constant;
  int data = 0;
  double number = 0;
};

struct LocalValue {
  double value = 0;
  double slope[3] = {};  // by a, b, c
  double bend[6] = {};   // by aa, ab, bb, ac, bc, cc
};

// Value at the operands `x`; with order 1 slopes, with order 2 bends as well. The value does not
// depend on the order.
LocalValue local_value(const TapeCall& call, const double* x, const TapeSources& sources,
                       int order);

// |x| rounded within `width`, as above.
inline double rounded_absolute(double x, double width) {
  const double size = x < 0 ? -x : x;
  if (!(size < width)) return size;
  const double t = x / width, squared = t * t;
  return width * (0.375 + squared * (0.75 - 0.125 * squared));
}

}  // namespace lapwing
