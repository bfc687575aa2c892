// SPDX-License-Identifier: Apache-2.0
// A tape: an expression compiled to a list of instructions, evaluated for several stages at once
// and differentiated in reverse on the part of it that each row reads.
//
// Several stages at once: every instruction works on `kLanes` instances side by side, in plain
// loops that the compiler vectorises; choosing what to do is paid once for all of them. Derivatives
// walk back through each row's own instructions only, and to the inputs that it reads. Curvature is
// the derivative of that walk, `kLanes` inputs at a time. A slope that meets no weight counts as
// none, even where it is infinite: what `select` does not take cannot spoil the rest.
//
// Immutable: evaluated from several threads at once, each with its own scratch memory.
#pragma once

#include <vector>

#include "framework/problem/expression_graph.h"
#include "framework/problem/stage_function.h"

namespace lapwing {

class Tape {
 public:
  static constexpr int kLanes = 8;

  // `place`: where in an instance's numbers each input of the graph stands; `width` of them.
  Tape(const ExpressionGraph& graph, const std::vector<int>& outputs, const std::vector<int>& place,
       int width);

  int rows() const { return static_cast<int>(rows_.size()); }
  int width() const { return width_; }
  int instructions() const { return static_cast<int>(instructions_.size()); }

  // As StageFunction::evaluate and curvature: row-major per instance, `jacobian` null or written
  // whole, `hessian` added to. Uses slots 0 and 1 of the workspace.
  void evaluate(int count, const double* inputs, const double* parameters, double* values,
                double* jacobian, Workspace& workspace) const;
  void curvature(int count, const double* inputs, const double* parameters,
                 const double* multipliers, double* hessian, Workspace& workspace) const;

 private:
  // Registers: constants, parameters, inputs, then one per instruction.
  struct Instruction {
    TapeCall call;
    int operands[3] = {};
    bool active[3] = {};  // whether an input stands behind the operand
    int slopes = -1;      // first of its slopes in the scratch memory, -1 where none are kept
  };
  struct Row {
    int output = 0;
    std::vector<int> reach;   // instructions between it and its inputs, last first
    std::vector<int> inputs;  // that it reads
  };

  void fill_known(const double* parameters, double* registers) const;
  void forward(double* registers, double* slopes) const;
  void backward(const Row& row, const double* registers, const double* slopes,
                double* adjoints) const;
  void bend(const LocalValue* local, const double* adjoints, double* tangents, double* bends) const;

  int width_ = 0, first_parameter_ = 0, first_input_ = 0, first_instruction_ = 0;
  int kept_slopes_ = 0;
  std::vector<double> constants_;
  std::vector<int> parameters_;  // which one each register holds
  std::vector<int> places_;      // of the inputs in an instance
  std::vector<Instruction> instructions_;
  std::vector<Row> rows_;
  std::vector<int> all_reach_;  // of any row, last first
  TapeSources sources_;
};

}  // namespace lapwing
