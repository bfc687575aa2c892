// SPDX-License-Identifier: Apache-2.0
// How: the constructor drops unused nodes of the graph and numbers the others as registers:
// constants, parameters, inputs, then one per instruction. For each row it lists the instructions
// between the row and its inputs (`reach`, last first).
//   forward    fills the registers of eight instances. Slopes that cannot be read off a register
//              again (division, functions) are kept.
//   backward   reverse mode, row by row: the adjoint of the output is 1; each instruction of
//              `reach` adds adjoint times slope to its operands. The adjoints of inputs are the
//              Jacobian.
//   curvature  one instance: forward with second derivatives, then the adjoints of sum_r lambda_r
//              row_r, then eight tangent directions at once (`bend`): tangents forward, and the
//              tangents of the adjoints backward. Those of the inputs are columns of the Hessian.
#include "framework/problem/tape.h"

#include <algorithm>
#include <set>

namespace lapwing {
namespace {

constexpr int kL = Tape::kLanes;

// Slopes that are neither constants nor registers.
int slopes_kept(TapeOp op) {
  switch (op) {
    case TapeOp::add:
    case TapeOp::subtract:
    case TapeOp::multiply:
    case TapeOp::negate:
    case TapeOp::select:
      return 0;
    default:
      return operand_count(op);
  }
}

// to += weight * slope, and nothing where there is no weight.
inline void pull(double* __restrict to, const double* __restrict weight,
                 const double* __restrict slope) {
  for (int l = 0; l < kL; ++l) to[l] += weight[l] != 0.0 ? weight[l] * slope[l] : 0.0;
}

}  // namespace

Tape::Tape(const ExpressionGraph& graph, const std::vector<int>& outputs,
           const std::vector<int>& place, int width)
    : width_(width), sources_(graph.sources()) {
  const auto& nodes = graph.nodes();
  std::vector<char> used(nodes.size(), 0), active(nodes.size(), 0);
  for (const int output : outputs) used[output] = 1;
  for (int i = static_cast<int>(nodes.size()) - 1; i >= 0; --i)
    for (int k = 0; used[i] && k < operand_count(nodes[i].call.op); ++k)
      used[nodes[i].operands[k]] = 1;

  std::vector<int> registers(nodes.size(), -1);
  int next = 0;
  const auto number = [&](TapeOp op, const auto& note) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!used[i] || nodes[i].call.op != op) continue;
      registers[i] = next++;
      note(nodes[i].call);
    }
  };
  number(TapeOp::constant, [&](const TapeCall& call) { constants_.push_back(call.number); });
  first_parameter_ = next;
  number(TapeOp::parameter, [&](const TapeCall& call) { parameters_.push_back(call.data); });
  first_input_ = next;
  number(TapeOp::input, [&](const TapeCall& call) { places_.push_back(place[call.data]); });
  first_instruction_ = next;

  for (std::size_t i = 0; i < nodes.size(); ++i) {
    active[i] = nodes[i].call.op == TapeOp::input;
    if (!used[i] || registers[i] >= 0) continue;
    Instruction instruction{.call = nodes[i].call};
    for (int k = 0; k < operand_count(nodes[i].call.op); ++k) {
      const int operand = nodes[i].operands[k];
      instruction.operands[k] = registers[operand];
      instruction.active[k] = active[operand];
      active[i] |= active[operand];
    }
    if (const int kept = slopes_kept(instruction.call.op); kept > 0 && active[i]) {
      instruction.slopes = kept_slopes_;
      kept_slopes_ += kept;
    }
    registers[i] = next++;
    instructions_.push_back(instruction);
  }

  std::set<int> all;
  for (const int output : outputs) {
    Row row{.output = registers[output], .reach = {}, .inputs = {}};
    std::vector<char> reached(next, 0);
    reached[row.output] = active[output];
    for (int i = instructions() - 1; i >= 0; --i) {
      if (!reached[first_instruction_ + i]) continue;
      row.reach.push_back(i);
      all.insert(i);
      for (int k = 0; k < 3; ++k)
        if (instructions_[i].active[k]) reached[instructions_[i].operands[k]] = 1;
    }
    for (int i = first_input_; i < first_instruction_; ++i)
      if (reached[i]) row.inputs.push_back(i);
    rows_.push_back(std::move(row));
  }
  all_reach_.assign(all.rbegin(), all.rend());
}

void Tape::fill_known(const double* parameters, double* registers) const {
  for (int i = 0; i < first_parameter_; ++i) std::fill_n(registers + i * kL, kL, constants_[i]);
  for (int i = first_parameter_; i < first_input_; ++i)
    std::fill_n(registers + i * kL, kL, parameters[parameters_[i - first_parameter_]]);
}

void Tape::forward(double* registers, double* slopes) const {
  double* __restrict out = registers + first_instruction_ * kL;
  for (const Instruction& instruction : instructions_) {
    const double* const a = registers + instruction.operands[0] * kL;
    const double* const b = registers + instruction.operands[1] * kL;
    const double* const c = registers + instruction.operands[2] * kL;
    const bool keep = slopes && instruction.slopes >= 0;
    double* const slope = keep ? slopes + instruction.slopes * kL : nullptr;
    switch (instruction.call.op) {
      case TapeOp::add:
        for (int l = 0; l < kL; ++l) out[l] = a[l] + b[l];
        break;
      case TapeOp::subtract:
        for (int l = 0; l < kL; ++l) out[l] = a[l] - b[l];
        break;
      case TapeOp::multiply:
        for (int l = 0; l < kL; ++l) out[l] = a[l] * b[l];
        break;
      case TapeOp::negate:
        for (int l = 0; l < kL; ++l) out[l] = -a[l];
        break;
      case TapeOp::select:
        for (int l = 0; l < kL; ++l) out[l] = a[l] > 0 ? b[l] : c[l];
        break;
      case TapeOp::divide:
        for (int l = 0; l < kL; ++l) out[l] = a[l] / b[l];
        if (keep)
          for (int l = 0; l < kL; ++l) {
            slope[l] = 1 / b[l];
            slope[kL + l] = -out[l] / b[l];
          }
        break;
      default: {
        const int count = operand_count(instruction.call.op);
        for (int l = 0; l < kL; ++l) {
          const double x[] = {a[l], b[l], c[l]};
          const LocalValue local = local_value(instruction.call, x, sources_, keep ? 1 : 0);
          out[l] = local.value;
          for (int k = 0; keep && k < count; ++k) slope[k * kL + l] = local.slope[k];
        }
      }
    }
    out += kL;
  }
}

void Tape::backward(const Row& row, const double* registers, const double* slopes,
                    double* adjoints) const {
  for (const int i : row.reach) std::fill_n(adjoints + (first_instruction_ + i) * kL, kL, 0.0);
  for (const int i : row.inputs) std::fill_n(adjoints + i * kL, kL, 0.0);
  std::fill_n(adjoints + row.output * kL, kL, 1.0);
  for (const int i : row.reach) {
    const Instruction& instruction = instructions_[i];
    const double* const weight = adjoints + (first_instruction_ + i) * kL;
    double* to[3];
    for (int k = 0; k < 3; ++k)
      to[k] = instruction.active[k] ? adjoints + instruction.operands[k] * kL : nullptr;
    switch (instruction.call.op) {
      case TapeOp::add:
      case TapeOp::subtract:
      case TapeOp::negate:
        if (to[0]) {
          const double sign = instruction.call.op == TapeOp::negate ? -1 : 1;
          for (int l = 0; l < kL; ++l) to[0][l] += sign * weight[l];
        }
        if (to[1]) {
          const double sign = instruction.call.op == TapeOp::subtract ? -1 : 1;
          for (int l = 0; l < kL; ++l) to[1][l] += sign * weight[l];
        }
        break;
      case TapeOp::multiply:
        if (to[0]) pull(to[0], weight, registers + instruction.operands[1] * kL);
        if (to[1]) pull(to[1], weight, registers + instruction.operands[0] * kL);
        break;
      case TapeOp::select: {
        const double* const choice = registers + instruction.operands[0] * kL;
        if (to[1])
          for (int l = 0; l < kL; ++l) to[1][l] += choice[l] > 0 ? weight[l] : 0.0;
        if (to[2])
          for (int l = 0; l < kL; ++l) to[2][l] += choice[l] > 0 ? 0.0 : weight[l];
        break;
      }
      default:
        for (int k = 0; k < 3; ++k)
          if (to[k]) pull(to[k], weight, slopes + (instruction.slopes + k) * kL);
    }
  }
}

void Tape::evaluate(int count, const double* inputs, const double* parameters, double* values,
                    double* jacobian, Workspace& workspace) const {
  const int size = (first_instruction_ + instructions()) * kL, m = rows();
  double* const registers = workspace.doubles(0, 2 * size + kept_slopes_ * kL);
  double* const adjoints = registers + size;
  double* const slopes = adjoints + size;
  fill_known(parameters, registers);
  for (int first = 0; first < count; first += kL) {
    const int lanes = std::min(kL, count - first);
    for (int i = 0; i < first_instruction_ - first_input_; ++i)
      for (int l = 0; l < kL; ++l)  // lanes to spare do what the last one does
        registers[(first_input_ + i) * kL + l] =
            inputs[(first + std::min(l, lanes - 1)) * width_ + places_[i]];
    forward(registers, jacobian ? slopes : nullptr);
    for (int r = 0; r < m; ++r)
      for (int l = 0; l < lanes; ++l)
        values[(first + l) * m + r] = registers[rows_[r].output * kL + l];
    if (!jacobian) continue;
    double* const block = jacobian + static_cast<std::size_t>(first) * m * width_;
    std::fill_n(block, static_cast<std::size_t>(lanes) * m * width_, 0.0);
    for (int r = 0; r < m; ++r) {
      backward(rows_[r], registers, slopes, adjoints);
      for (const int i : rows_[r].inputs)
        for (int l = 0; l < lanes; ++l)
          block[(l * m + r) * width_ + places_[i - first_input_]] = adjoints[i * kL + l];
    }
  }
}

void Tape::curvature(int count, const double* inputs, const double* parameters,
                     const double* multipliers, double* hessian, Workspace& workspace) const {
  const int all = first_instruction_ + instructions(), read = first_instruction_ - first_input_;
  static_assert(sizeof(LocalValue) % sizeof(double) == 0);
  double* const registers = workspace.doubles(0, 2 * all * (1 + kL));
  double* const adjoints = registers + all;
  double* const tangents = adjoints + all;
  double* const bends = tangents + all * kL;  // the tangents of the adjoints
  auto* const local = reinterpret_cast<LocalValue*>(
      workspace.doubles(1, instructions() * (sizeof(LocalValue) / sizeof(double))));
  std::copy(constants_.begin(), constants_.end(), registers);
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    registers[first_parameter_ + i] = parameters[parameters_[i]];
  for (int instance = 0; instance < count; ++instance) {
    for (int i = 0; i < read; ++i)
      registers[first_input_ + i] = inputs[instance * width_ + places_[i]];
    for (int i = 0; i < instructions(); ++i) {
      const Instruction& instruction = instructions_[i];
      double x[3];
      for (int k = 0; k < 3; ++k) x[k] = registers[instruction.operands[k]];
      local[i] = local_value(instruction.call, x, sources_, 2);
      registers[first_instruction_ + i] = local[i].value;
    }
    std::fill_n(adjoints, all, 0.0);
    for (int r = 0; r < rows(); ++r)
      adjoints[rows_[r].output] += multipliers[instance * rows() + r];
    for (const int i : all_reach_) {
      const double weight = adjoints[first_instruction_ + i];
      if (weight == 0) continue;
      for (int k = 0; k < 3; ++k)
        if (instructions_[i].active[k])
          adjoints[instructions_[i].operands[k]] += weight * local[i].slope[k];
    }
    for (int first = 0; first < read; first += kL) {
      const int lanes = std::min(kL, read - first);
      std::fill_n(tangents, 2 * all * kL, 0.0);
      for (int l = 0; l < lanes; ++l) tangents[(first_input_ + first + l) * kL + l] = 1;
      bend(local, adjoints, tangents, bends);
      for (int l = 0; l < lanes; ++l)
        for (int i = 0; i <= first + l; ++i) {
          const double value = bends[(first_input_ + i) * kL + l];
          const int row = places_[first + l], column = places_[i];
          hessian[(instance * width_ + row) * width_ + column] += value;
          if (i != first + l) hessian[(instance * width_ + column) * width_ + row] += value;
        }
    }
  }
}

// Tangents forward, then the tangents of the adjoints backward.
void Tape::bend(const LocalValue* local, const double* adjoints, double* tangents,
                double* bends) const {
  for (auto it = all_reach_.rbegin(); it != all_reach_.rend(); ++it) {
    const Instruction& instruction = instructions_[*it];
    double* const out = tangents + (first_instruction_ + *it) * kL;
    for (int k = 0; k < 3; ++k)
      if (instruction.active[k]) {
        const double slope = local[*it].slope[k];
        if (slope == 0) continue;  // not taken, and perhaps infinite
        const double* const in = tangents + instruction.operands[k] * kL;
        for (int l = 0; l < kL; ++l) out[l] += in[l] != 0.0 ? slope * in[l] : 0.0;
      }
  }
  constexpr int kPacked[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
  for (const int i : all_reach_) {
    const Instruction& instruction = instructions_[i];
    const double* const weight = bends + (first_instruction_ + i) * kL;
    const double adjoint = adjoints[first_instruction_ + i];
    for (int k = 0; k < 3; ++k) {
      if (!instruction.active[k]) continue;
      double* const to = bends + instruction.operands[k] * kL;
      const double slope = local[i].slope[k];
      for (int l = 0; l < kL; ++l) to[l] += weight[l] != 0.0 ? weight[l] * slope : 0.0;
      for (int j = 0; adjoint != 0 && j < 3; ++j) {
        const double curve = adjoint * local[i].bend[kPacked[k][j]];
        if (!instruction.active[j] || curve == 0) continue;
        const double* const in = tangents + instruction.operands[j] * kL;
        for (int l = 0; l < kL; ++l) to[l] += in[l] != 0.0 ? curve * in[l] : 0.0;
      }
    }
  }
}

}  // namespace lapwing
