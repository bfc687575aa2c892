// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/operation_value.h"

#include <cmath>
#include <limits>

namespace lapwing {
namespace {

// |x|, rounded within `width`: there the even polynomial of fourth degree that meets |x| at the
// width with slope and curvature.
double rounded_size(double x, double width) {
  const double size = std::abs(x);
  if (!(size < width)) return size;
  const double share = size / width;
  return width * (3.0 / 8 + 3.0 / 4 * share * share - 1.0 / 8 * std::pow(share, 4));
}

}  // namespace

double operation_value(const ConstraintStep& step, std::span<const double> values) {
  const auto operand = [&](int k) { return values[static_cast<std::size_t>(step.operands[k])]; };
  switch (step.op) {
    case ConstraintOp::constant:
      return step.number;
    case ConstraintOp::add:
      return operand(0) + operand(1);
    case ConstraintOp::subtract:
      return operand(0) - operand(1);
    case ConstraintOp::multiply:
      return operand(0) * operand(1);
    case ConstraintOp::divide:
      return operand(0) / operand(1);
    case ConstraintOp::negate:
      return -operand(0);
    case ConstraintOp::sin:
      return std::sin(operand(0));
    case ConstraintOp::cos:
      return std::cos(operand(0));
    case ConstraintOp::tan:
      return std::tan(operand(0));
    case ConstraintOp::exp:
      return std::exp(operand(0));
    case ConstraintOp::log:
      return std::log(operand(0));
    case ConstraintOp::sqrt:
      return std::sqrt(operand(0));
    case ConstraintOp::power:
      return std::pow(operand(0), step.number);
    case ConstraintOp::atan2:
      return std::atan2(operand(0), operand(1));
    case ConstraintOp::absolute:
      return rounded_size(operand(0), step.number);
    case ConstraintOp::norm: {
      const double root = std::sqrt(operand(0));
      return root < step.number ? rounded_size(root, step.number) : root;
    }
    case ConstraintOp::maximum: {
      const double a = operand(0), b = operand(1);
      if (!(std::abs(a - b) < step.number)) return std::max(a, b);
      return 0.5 * (a + b + rounded_size(a - b, step.number));
    }
    case ConstraintOp::select:
      return operand(0) > 0 ? operand(1) : operand(2);
    case ConstraintOp::input:
    case ConstraintOp::subject:
    case ConstraintOp::distance:
      break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace lapwing
