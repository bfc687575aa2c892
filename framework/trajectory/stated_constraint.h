// SPDX-License-Identifier: Apache-2.0
// A constraint that a script states itself, as a plan carries it: the operations that compute its
// values, and their bounds. Whoever reads the plan can evaluate it without the script.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/trajectory/time_span.h"

namespace lapwing {

// README.md says what each gives.
enum class ConstraintOp {
  constant,
  input,
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
  power,
  atan2,
  absolute,
  norm,
  maximum,
  select,
  subject,
  distance,
};
inline constexpr int kConstraintOps = 21;

// Its word in a plan.
const char* name_of(ConstraintOp op);
// 0 to 3.
int operand_count(ConstraintOp op);

// One operation, on the results of earlier ones.
struct ConstraintStep {
  ConstraintOp op = ConstraintOp::constant;
  int operands[3] = {-1, -1, -1};  // places in the list of operations
  double number = 0;  // a constant, the exponent of a power, the width of a rounded kink,
                      // the reach of a distance: what is farther is as far as that, m
  // Of an input: the block, its component, and how many samples later than the constraint's own
  // one. Of a subject: its name and a component of its position. Of a distance: no name, and the
  // place in the environment's list of obstacles.
  std::string name = {};
  int component = 0, later = 0;
};

// One value of a constraint; an absent bound does not bound it.
struct ConstraintResult {
  int operation = 0;
  std::optional<double> lower = std::nullopt, upper = std::nullopt;
};

struct StatedConstraint {
  // Operations of one constraint that a plan may hold.
  static constexpr int kMostOperations = 100'000;
  static constexpr int kMostResults = 256;
  static constexpr int kMostLater = 63;

  std::string name;
  bool required = true;       // else what comes of it is reported alone
  std::string unjudged = {};  // why it cannot be evaluated; then there is nothing below
  std::vector<ConstraintStep> operations = {};
  std::vector<ConstraintResult> results = {};
  std::vector<double> times = {};                 // s, when it is asked; none: always
  std::vector<TimeSpan> spans = {}, except = {};  // asked inside one of these, and in none of those
};

}  // namespace lapwing
