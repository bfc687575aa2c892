// SPDX-License-Identifier: Apache-2.0
// A cost term or constraint that a script states itself: how it enters the problem, and what the
// plan says of it.
#pragma once

#include <string>
#include <vector>

#include "framework/symbolic/term_formula.h"

namespace lapwing {

enum class WrittenTermKind { cost, constraint };

struct WrittenTerm {
  WrittenTermKind kind = WrittenTermKind::cost;
  std::string name;
  double weight = 1, width = 0;
  TapeFunction shape;
  std::vector<double> lower,
      upper;  // of a constraint: none, one for all rows, or one each
  Origin origin;
  TermParameters parameters;
  // Of a constraint: whether the certificate requires it, whether solvers hold it, and what the
  // plan states of it.
  bool required = true, held = true;
  RecordedOperations recorded;
  StatedConstraint stated;

  // "cost" or "constraint", and that with the name: "cost 'keep_low'".
  const char* word() const { return kind == WrittenTermKind::cost ? "cost" : "constraint"; }
  std::string what() const { return std::string(word()) + " '" + name + "'"; }
};

// Compiles what the term's function gave for `formula` and adds the term to the problem, which
// keeps its parameters alive. `place` is where the function is written. InputError for bounds that
// are not of the rows' number or whose lower is above its upper, and for neighbouring stages that
// are read at given times.
void add_written_term(WrittenTerm& term, TermFormula& formula, const SymbolicEntries& rows,
                      const Origin& place, TrajectoryProblem& problem);

// What the plan of a solution says of the constraint: with its parameters as they are now.
StatedConstraint stated_constraint(const WrittenTerm& term);

}  // namespace lapwing
