// SPDX-License-Identifier: Apache-2.0
// One solution made of those of its parts, which were solved one after the other.
#pragma once

#include <vector>

#include "framework/mission/run.h"

namespace lapwing {

// Stages `first` to `last` of a solution, counted from 0.
struct SolutionPart {
  const SolutionObject* solution = nullptr;
  int first = 0, last = 0;
};

// The solution of `whole` (a finished problem) whose stages are those of the parts, in order. Costs
// and violations are those of the whole. Its status is `feasible` where every row and bound of the
// whole is met to 1e-5, else that of the first part that is neither optimal nor feasible.
// InputError where parts have other blocks than the whole or do not make all its stages.
SolutionObject join(const ProblemObject& whole, const std::vector<SolutionPart>& parts);

}  // namespace lapwing
