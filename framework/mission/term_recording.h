// SPDX-License-Identifier: Apache-2.0
// Recording what the function of a term does, as a tape (problem/tape.h).
//
// The function runs once on symbolic values of a stage; what it returns is compiled. Lua cannot
// trap every way to decide by a value (`x == 3`, `x and a or b`), so once the problem is finished
// the function also runs on plain numbers: at 32 seeded points, at stages of the first guess, and
// with every number set to those that stand in its lines. Where the tape says something else, the
// function decided, or depends on something that changes from call to call, and that is an error.
#pragma once

#include <vector>

#include "framework/mission/symbolic_values.h"
#include "framework/symbolic/trial_point.h"

namespace lapwing {

class TermRecording {
 public:
  TermRecording(lua_State* state, TermFormula& formula);
  ~TermRecording();
  TermRecording(const TermRecording&) = delete;
  TermRecording& operator=(const TermRecording&) = delete;

  // What the function at `function` of the Lua stack computes from symbolic values of a stage.
  // InputError for whatever is wrong with it.
  SymbolicEntries record(int function);
  // Whether the tape says what the function says; `guess` is the finished problem's. InputError
  // with the place, and the numbers where it does not, or where it has no value anywhere.
  void check(int function, const TapeFunction& result, const Eigen::MatrixXd& guess);

  // For the stage that the function is given.
  TermFormula& formula() { return formula_; }
  SymbolicEntries read(int stage, int block);
  // The recording under way; an error where there is none.
  static TermRecording& current(lua_State* state);

 private:
  void push_parameters();
  // Runs the function and returns all numbers that it returned.
  SymbolicEntries call(int function);
  void collect(int index, int depth, SymbolicEntries& rows);
  void raise(int message);  // does not return
  std::vector<double> literals(int function) const;
  void compare(int function, const TapeFunction& result, std::vector<bool>& finite);

  lua_State* state_;
  TermFormula& formula_;
  TrialPoint point_;
  bool symbolic_ = true;  // else the function runs on the numbers of the point
};

// Where a function of a script begins; nothing for one of C++.
Origin place_of_function(lua_State* state, int function);

// Adds the type of a stage; pushes one, `stage` places after the window's first.
void open_stage_values(lua_State* state);
void push_stage(lua_State* state, int stage, std::uint64_t serial);

}  // namespace lapwing
