// SPDX-License-Identifier: Apache-2.0
// An expression of numbers that are not known yet: what a term written in a script is recorded as.
//
// Nodes are numbered in the order they came to be, operands before what uses them. Equal nodes are
// one (a + b and b + a as well), and operations on constants are carried out at once: what a script
// writes twice is computed once, and what it could have written shorter costs nothing more.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "framework/problem/tape_operation.h"

namespace lapwing {

struct ExpressionNode {
  TapeCall call;
  int operands[3] = {-1, -1, -1};
};

class ExpressionGraph {
 public:
  int constant(double value);
  int input(int index);
  int parameter(int index);
  // A node of `op` on as many nodes as it takes. InputError beyond a million nodes.
  int apply(TapeOp op, int a, int b = -1, int c = -1, double number = 0, int data = 0);

  const std::vector<ExpressionNode>& nodes() const { return nodes_; }
  const ExpressionNode& node(int index) const { return nodes_[index]; }
  bool is_constant(int index) const { return nodes_[index].call.op == TapeOp::constant; }
  double number(int index) const { return nodes_[index].call.number; }

  // Indices for TapeOp::track and TapeOp::distance.
  int add_subject(const Subject& subject);
  // `obstacle`: whose distance the field is, its place in the environment.
  int add_field(std::shared_ptr<const DistanceField> field, int obstacle);
  const TapeSources& sources() const { return sources_; }
  int obstacle_of_field(int index) const { return obstacles_of_fields_[index]; }

  // Whether every output is a straight function of the inputs, with slopes that no parameter
  // changes. `known` says which inputs no solver moves, such as the time of a fixed horizon.
  bool affine(const std::vector<int>& outputs, const std::function<bool(int)>& known) const;

 private:
  using Key = std::tuple<TapeOp, int, int, int, double, int>;
  int insert(const ExpressionNode& node);
  int simpler(TapeOp op, int a, int b) const;

  std::vector<ExpressionNode> nodes_;
  std::map<Key, int> known_;
  TapeSources sources_;
  std::vector<int> obstacles_of_fields_;
};

}  // namespace lapwing
