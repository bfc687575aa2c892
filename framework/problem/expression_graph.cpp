// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/expression_graph.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/core/error.h"

namespace lapwing {

int ExpressionGraph::insert(const ExpressionNode& node) {
  constexpr std::size_t kMostNodes = 1'000'000;
  const double number = node.call.number;
  // Zeros of both signs are told apart by the flag; no node holds what is no number.
  const int data = node.call.data * 2 + (std::signbit(number) ? 1 : 0);
  const Key key{node.call.op, node.operands[0], node.operands[1], node.operands[2], number, data};
  if (number == number) {
    const auto [place, fresh] = known_.try_emplace(key, static_cast<int>(nodes_.size()));
    if (!fresh) return place->second;
  }
  if (nodes_.size() >= kMostNodes)
    throw InputError("the function makes more than a million operations");
  nodes_.push_back(node);
  return static_cast<int>(nodes_.size()) - 1;
}

int ExpressionGraph::constant(double value) {
  return insert({{TapeOp::constant, 0, value}, {}});
}
int ExpressionGraph::input(int index) {
  return insert({{TapeOp::input, index, 0}, {}});
}
int ExpressionGraph::parameter(int index) {
  return insert({{TapeOp::parameter, index, 0}, {}});
}

// A node that equals op(a, b) whatever the inputs are, or -1.
int ExpressionGraph::simpler(TapeOp op, int a, int b) const {
  const auto is = [this](int node, double value) {
    return node >= 0 && is_constant(node) && number(node) == value;
  };
  switch (op) {
    case TapeOp::add:
      return is(a, 0) ? b : is(b, 0) ? a : -1;
    case TapeOp::subtract:
      return is(b, 0) ? a : -1;
    case TapeOp::multiply:
      if (is(a, 1) || is(b, 0)) return b;
      return is(b, 1) || is(a, 0) ? a : -1;
    case TapeOp::divide:
      return is(b, 1) || (is(a, 0) && !is(b, 0)) ? a : -1;
    case TapeOp::negate:
      return nodes_[a].call.op == TapeOp::negate ? nodes_[a].operands[0] : -1;
    default:
      return -1;
  }
}

int ExpressionGraph::apply(TapeOp op, int a, int b, int c, double number, int data) {
  const bool swaps = op == TapeOp::add || op == TapeOp::multiply;
  if (swaps && b < a) std::swap(a, b);
  const int operands[] = {a, b, c};
  const int count = operand_count(op);
  double x[3] = {};
  bool folds = true;
  for (int k = 0; k < count; ++k) {
    folds &= is_constant(operands[k]);
    x[k] = this->number(operands[k]);
  }
  const TapeCall call{op, data, number};
  if (folds) return constant(local_value(call, x, sources_, 0).value);
  if (op == TapeOp::select && is_constant(a)) return x[0] > 0 ? b : c;
  if (const int same = simpler(op, a, b); same >= 0) return same;
  return insert({call, {a, b, c}});
}

int ExpressionGraph::add_subject(const Subject& subject) {
  for (std::size_t k = 0; k < sources_.subjects.size(); ++k)
    if (sources_.subjects[k].name == subject.name) return static_cast<int>(k);
  sources_.subjects.push_back(subject);
  return static_cast<int>(sources_.subjects.size()) - 1;
}

int ExpressionGraph::add_field(std::shared_ptr<const DistanceField> field, int obstacle) {
  for (std::size_t k = 0; k < sources_.fields.size(); ++k)
    if (sources_.fields[k] == field) return static_cast<int>(k);
  sources_.fields.push_back(std::move(field));
  obstacles_of_fields_.push_back(obstacle);
  return static_cast<int>(sources_.fields.size()) - 1;
}

bool ExpressionGraph::affine(const std::vector<int>& outputs,
                             const std::function<bool(int)>& known) const {
  // How a node depends on what solvers move, and whether a parameter changes it between solves.
  enum Degree { none, straight, bent };
  struct Kind {
    Degree degree = none;
    bool changes = false;
  };
  std::vector<Kind> kinds(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const ExpressionNode& node = nodes_[i];
    Kind& kind = kinds[i];
    const TapeOp op = node.call.op;
    if (op == TapeOp::input && !known(node.call.data)) kind.degree = straight;
    if (op == TapeOp::parameter) kind.changes = true;
    const int count = operand_count(op);
    for (int k = 0; k < count; ++k) {
      const Kind& of = kinds[node.operands[k]];
      kind.degree = std::max(kind.degree, of.degree);
      kind.changes |= of.changes;
    }
    if (kind.degree == none || op == TapeOp::input || op == TapeOp::add || op == TapeOp::subtract ||
        op == TapeOp::negate)
      continue;
    const auto fixed = [&](int k) {
      const Kind& of = kinds[node.operands[k]];
      return of.degree == none && !of.changes;
    };
    if (op == TapeOp::multiply && (fixed(0) || fixed(1))) continue;
    if (op == TapeOp::divide && fixed(1)) continue;
    kind.degree = bent;
  }
  for (const int output : outputs)
    if (kinds[output].degree == bent) return false;
  return true;
}

}  // namespace lapwing
