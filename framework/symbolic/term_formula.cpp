// SPDX-License-Identifier: Apache-2.0
#include "framework/symbolic/term_formula.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "framework/core/log.h"
#include "framework/problem/environment_distance.h"

namespace lapwing {

namespace {

constexpr std::size_t kManyOperations = 20'000;  // of a tape: a solve takes minutes

std::uint64_t next_serial() {
  static std::uint64_t serial = 0;
  return ++serial;
}

}  // namespace

TermFormula::TermFormula(std::string what, const TrajectoryProblem& problem,
                         const TermParameters& parameters, double width)
    : problem_(problem), parameters_(parameters), layout_(problem.layout()) {
  setting_.what = std::move(what);
  setting_.width = width;
  setting_.serial = next_serial();
  for (const char* clock : {"time", "step"})
    if (layout_.find(clock) < 0)
      layout_.add({.name = clock, .unit = "s", .role = BlockRole::clock});
}

// ---- what it reads
// ------------------------------------------------------------------------------

std::optional<double> TermFormula::known_step(int block) const {
  const Horizon& horizon = problem_.horizon();
  if (layout_.block(block).name != "step" || !horizon.uniform() || horizon.step_free)
    return std::nullopt;
  return horizon.step;
}

SymbolicEntries TermFormula::read(int stage, int block) {
  if (const auto step = known_step(block)) return {{.value = *step}};
  const BlockSpec& spec = layout_.block(block);
  SymbolicEntries entries(spec.size);
  for (int i = 0; i < spec.size; ++i) {
    const auto same = std::find_if(inputs_.begin(), inputs_.end(), [&](const Input& input) {
      return input.stage == stage && input.block == block && input.component == i;
    });
    const auto index = static_cast<int>(same - inputs_.begin());
    if (same == inputs_.end()) inputs_.push_back({stage, block, i});
    entries[i].node = setting_.graph.input(index);
  }
  return entries;
}

SymbolicEntries TermFormula::read(const TermParameter& parameter) {
  SymbolicEntries entries(parameter.size);
  for (int i = 0; i < parameter.size; ++i)
    entries[i].node = setting_.graph.parameter(parameter.first + i);
  return entries;
}

SymbolicEntries TermFormula::subject(const Subject& subject, const SymbolicScalar& time) {
  const int number = setting_.graph.add_subject(subject), at = symbolic_node(setting_, time);
  SymbolicEntries place(3);
  for (int i = 0; i < 3; ++i)
    place[i] = symbolic_of_node(setting_,
                                setting_.graph.apply(TapeOp::track, at, -1, -1, 0, 3 * number + i));
  return place;
}

SymbolicScalar TermFormula::distance(const SymbolicEntries& point, const std::string& obstacle) {
  int nodes[3];
  for (int i = 0; i < 3; ++i) nodes[i] = symbolic_node(setting_, point[i]);
  return symbolic_of_node(setting_, nearest_distance(setting_.graph, problem_.environment(),
                                                     obstacle, nodes, setting_.width));
}

// ---- what comes of it
// ---------------------------------------------------------------------------

// Blocks and window of the result; `places` says where each input stands in an instance.
void TermFormula::list_inputs(TapeFunction& result, std::vector<int>& places, int& width) const {
  std::vector<int> blocks;
  for (const Input& input : inputs_) {
    result.window = std::max(result.window, input.stage + 1);
    if (std::find(blocks.begin(), blocks.end(), input.block) == blocks.end())
      blocks.push_back(input.block);
  }
  if (blocks.empty()) blocks.push_back(layout_.index("step"));  // a constant, once an instance
  std::map<int, int> offsets;
  int stride = 0;
  result.blocks.clear();
  for (const int block : blocks) {
    result.blocks.push_back(layout_.block(block).name);
    offsets[block] = stride;
    stride += layout_.block(block).size;
  }
  for (const Input& input : inputs_)
    places.push_back(input.stage * stride + offsets[input.block] + input.component);
  width = stride * result.window;
}

void TermFormula::compile(const SymbolicEntries& rows, const Origin& place, TapeFunction& result) {
  std::vector<int> outputs, places;
  for (const SymbolicScalar& row : rows) {
    if (row.known() && !std::isfinite(row.value))
      throw InputError(place, setting_.what + ": returns no finite number whatever the stage is");
    outputs.push_back(symbolic_node(setting_, row));
  }
  outputs_ = outputs;
  int width = 0;
  list_inputs(result, places, width);
  const bool free = problem_.horizon().step_free;
  result.affine = setting_.graph.affine(outputs, [&](int input) {
    return layout_.block(inputs_[input].block).role == BlockRole::clock && !free;
  });
  result.tape = std::make_shared<const Tape>(setting_.graph, outputs, places, width);
  const std::string written = place.to_string();
  result.written_at = (written.empty() ? "" : written + ": ") + setting_.what;
  if (inputs_.empty() && parameters_.list.empty())
    logging::warning(result.written_at + ": is the same number whatever the stage is");
  const std::size_t operations = setting_.graph.nodes().size();
  if (operations > kManyOperations)
    logging::warning(result.written_at + ": takes " + std::to_string(operations) +
                     " operations at every stage; solving will be slow");
}

}  // namespace lapwing
