// SPDX-License-Identifier: Apache-2.0
// Recording what the function of a term does, as a tape (problem/tape.h).
//
// The function runs once on symbolic values of a stage; what it returns is compiled. Lua cannot
// trap every way to decide by a value (`x == 3`, `x and a or b`), so once the problem is finished
// the function also runs on plain numbers: at 32 seeded points, at stages of the first guess, and
// with every number set to those that stand in its lines. Where the tape says something else, the
// function decided, or depends on something that changes from call to call, and that is an error.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/random.h"
#include "framework/mission/symbolic_values.h"
#include "framework/problem/tape_function.h"
#include "framework/problem/trajectory_problem.h"
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

class TermRecording {
 public:
  TermRecording(lua_State* state, std::string what, const TrajectoryProblem& problem,
                const TermParameters& parameters, double width);
  ~TermRecording();
  TermRecording(const TermRecording&) = delete;
  TermRecording& operator=(const TermRecording&) = delete;

  // Records the function at `function` of the Lua stack into `result`: its tape, blocks and window,
  // which is at least the one that is there. InputError for whatever is wrong with it.
  void record(int function, TapeFunction& result);
  // The same as data, once it is recorded.
  RecordedOperations operations() const;

  // Whether the tape says what the function says; `guess` is the finished problem's. InputError
  // with the place, and the numbers where it does not, or where it has no value anywhere.
  void check(int function, const TapeFunction& result, const Eigen::MatrixXd& guess);

  // For the stage that the function is given.
  const StageLayout& layout() const { return layout_; }
  const TrajectoryProblem& problem() const { return problem_; }
  SymbolicSetting& setting() { return setting_; }
  SymbolicEntries read(int stage, int block);
  // The recording under way; an error where there is none.
  static TermRecording& current(lua_State* state);

 private:
  struct Input {
    int stage, block, component;
  };

  void push_parameters();
  // Runs the function and returns all numbers that it returned.
  SymbolicEntries call(int function);
  void collect(int index, int depth, SymbolicEntries& rows);
  void raise(int message);  // does not return
  std::vector<double> literals(int function) const;
  const std::vector<double>& numbers(int stage, int block);
  void begin_point(int point);
  void list_inputs(TapeFunction& result, std::vector<int>& places, int& width) const;
  void check_point(const Origin& place, const TapeFunction& result, const SymbolicEntries& rows,
                   std::vector<bool>& finite);
  std::string values_here() const;

  lua_State* state_;
  const TrajectoryProblem& problem_;
  const TermParameters& parameters_;
  StageLayout layout_;  // with the clock
  SymbolicSetting setting_;
  bool symbolic_ = true;
  std::vector<Input> inputs_;
  std::vector<int> outputs_;                                    // nodes
  std::map<std::pair<int, int>, std::vector<double>> numbers_;  // of a point, by stage and block
  std::vector<double> point_parameters_;
  Random random_{1};
  int point_ = 0;
  std::optional<double> literal_;           // every number of this point
  const Eigen::MatrixXd* guess_ = nullptr;  // the point is this stage of it, where that is one
  int guess_stage_ = -1;
};

// Where a function of a script begins; nothing for one of C++.
Origin place_of_function(lua_State* state, int function);

// Adds the type of a stage; pushes one, `stage` places after the window's first.
void open_stage_values(lua_State* state);
void push_stage(lua_State* state, int stage, std::uint64_t serial);

}  // namespace lapwing
