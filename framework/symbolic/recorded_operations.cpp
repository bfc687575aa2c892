// SPDX-License-Identifier: Apache-2.0
// A recorded term as the operations that a plan states.
#include <algorithm>

#include "framework/symbolic/term_formula.h"

namespace lapwing {

namespace {

ConstraintOp stated_op(TapeOp op) {
  switch (op) {
    case TapeOp::constant:
    case TapeOp::parameter:
      return ConstraintOp::constant;
    case TapeOp::input:
      return ConstraintOp::input;
    case TapeOp::add:
      return ConstraintOp::add;
    case TapeOp::subtract:
      return ConstraintOp::subtract;
    case TapeOp::multiply:
      return ConstraintOp::multiply;
    case TapeOp::divide:
      return ConstraintOp::divide;
    case TapeOp::negate:
      return ConstraintOp::negate;
    case TapeOp::sin:
      return ConstraintOp::sin;
    case TapeOp::cos:
      return ConstraintOp::cos;
    case TapeOp::tan:
      return ConstraintOp::tan;
    case TapeOp::exp:
      return ConstraintOp::exp;
    case TapeOp::log:
      return ConstraintOp::log;
    case TapeOp::sqrt:
      return ConstraintOp::sqrt;
    case TapeOp::power:
      return ConstraintOp::power;
    case TapeOp::atan2:
      return ConstraintOp::atan2;
    case TapeOp::absolute:
      return ConstraintOp::absolute;
    case TapeOp::norm:
      return ConstraintOp::norm;
    case TapeOp::maximum:
      return ConstraintOp::maximum;
    case TapeOp::select:
      return ConstraintOp::select;
    case TapeOp::track:
      return ConstraintOp::subject;
    case TapeOp::distance:
      return ConstraintOp::distance;
  }
  throw Error("an operation that plans do not have");
}

// What the results need, operands before what uses them.
std::vector<char> used_nodes(const ExpressionGraph& graph, const std::vector<int>& outputs) {
  std::vector<char> used(graph.nodes().size(), 0);
  for (const int output : outputs) used[output] = 1;
  for (int i = static_cast<int>(used.size()) - 1; i >= 0; --i)
    for (int k = 0; used[i] && k < operand_count(graph.node(i).call.op); ++k)
      used[graph.node(i).operands[k]] = 1;
  return used;
}

}  // namespace

RecordedOperations TermFormula::operations() const {
  constexpr double kFarthest = 1e9;  // m
  const ExpressionGraph& graph = setting_.graph;
  const std::vector<char> used = used_nodes(graph, outputs_);
  std::vector<int> places(used.size(), -1);
  RecordedOperations recorded;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const ExpressionNode& node = graph.node(static_cast<int>(i));
    const TapeCall& call = node.call;
    places[i] = static_cast<int>(recorded.operations.size());
    ConstraintStep step{.op = stated_op(call.op), .number = call.number};
    for (int k = 0; k < operand_count(call.op); ++k) step.operands[k] = places[node.operands[k]];
    if (call.op == TapeOp::parameter) recorded.parameters.emplace_back(places[i], call.data);
    if (call.op == TapeOp::input) {
      const Input& input = inputs_[call.data];
      step.name = layout_.block(input.block).name;
      step.component = input.component;
      step.later = input.stage;
    } else if (call.op == TapeOp::track) {
      step.name = graph.sources().subjects[call.data / 3].name;
      step.component = call.data % 3;
    } else if (call.op == TapeOp::distance) {
      step.component = graph.obstacle_of_field(call.data);
      step.number = std::min(kFarthest, graph.sources().fields[call.data]->reach());
    }
    recorded.operations.push_back(std::move(step));
  }
  for (const int output : outputs_) recorded.results.push_back(places[output]);
  return recorded;
}

}  // namespace lapwing
