// SPDX-License-Identifier: Apache-2.0
// Cost terms and constraints that are tapes: how a function written in a script reaches solvers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/problem/constraint.h"
#include "framework/problem/cost_term.h"
#include "framework/problem/tape.h"
#include "framework/trajectory/time_span.h"

namespace lapwing {

struct TapeFunction {
  // Of an instance: stage by stage, in each the blocks in this order.
  std::vector<std::string> blocks;
  int window = 1;
  std::vector<std::string> row_names = {};  // empty: numbered
  std::vector<double> times = {};           // as in FunctionShape
  bool integral = false;
  bool affine = false;
  std::vector<TimeSpan> spans = {}, except = {};  // as `ask_within` takes them
  std::shared_ptr<const Tape> tape;
  std::string written_at = {};  // "shot.lua:12: cost 'keep_low'": for messages
  // Read at every evaluation: may be changed between two solves, never during one.
  std::shared_ptr<const std::vector<double>> parameters;
};

std::unique_ptr<CostTerm> tape_cost(TapeFunction function);
// `lower` and `upper` hold one number per row, the same at every instance.
std::unique_ptr<Constraint> tape_constraint(TapeFunction function, std::vector<double> lower,
                                            std::vector<double> upper);

}  // namespace lapwing
