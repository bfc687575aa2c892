// SPDX-License-Identifier: Apache-2.0
// What a term computes from a window of stages, while it is recorded: which blocks it reads, and
// the operations on them. The language that it is written in is not known here.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/problem/tape_function.h"
#include "framework/problem/trajectory_problem.h"
#include "framework/symbolic/symbolic_number.h"
#include "framework/trajectory/stated_constraint.h"

namespace lapwing {

// Numbers that a term reads and a script may change between two solves.
struct TermParameter {
  std::string name;
  int first = 0, size = 0;  // in TermParameters::values
  bool scalar = true;
};
struct TermParameters {
  std::vector<TermParameter> list;
  std::shared_ptr<std::vector<double>> values = std::make_shared<std::vector<double>>();
};

// What a function does, as a plan states it (trajectory/stated_constraint.h).
struct RecordedOperations {
  std::vector<ConstraintStep> operations;
  std::vector<int> results;                     // places in it
  std::vector<std::pair<int, int>> parameters;  // constants that hold one: place, parameter
};

class TermFormula {
 public:
  // `what` names the term in messages; kinks are rounded within `width`. Problem and parameters
  // outlive it.
  TermFormula(std::string what, const TrajectoryProblem& problem, const TermParameters& parameters,
              double width);

  const TrajectoryProblem& problem() const { return problem_; }
  // Of a stage: the problem's blocks, `time` and `step`.
  const StageLayout& layout() const { return layout_; }
  const TermParameters& parameters() const { return parameters_; }
  SymbolicSetting& setting() { return setting_; }

  // The numbers of a block, `stage` places after the first of the window.
  SymbolicEntries read(int stage, int block);
  SymbolicEntries read(const TermParameter& parameter);
  // The length of the steps where `block` is that and nothing changes it.
  std::optional<double> known_step(int block) const;
  // Where a subject is at a time, and how far the nearest obstacle is from a point, or the one of
  // that name: InputError for an unknown one, naming the known ones.
  SymbolicEntries subject(const Subject& subject, const SymbolicScalar& time);
  SymbolicScalar distance(const SymbolicEntries& point, const std::string& obstacle);

  // What the term computes: its tape, blocks and window, which is at least the one that is there.
  // `place` is where it is written. Warns of a term that reads nothing, and of one that takes very
  // many operations. InputError for a row that is never a finite number.
  void compile(const SymbolicEntries& rows, const Origin& place, TapeFunction& result);
  // The same as data, once it is compiled.
  RecordedOperations operations() const;

 private:
  struct Input {
    int stage, block, component;
  };

  void list_inputs(TapeFunction& result, std::vector<int>& places, int& width) const;

  const TrajectoryProblem& problem_;
  const TermParameters& parameters_;
  StageLayout layout_;
  SymbolicSetting setting_;
  std::vector<Input> inputs_;
  std::vector<int> outputs_;  // nodes
};

}  // namespace lapwing
