// SPDX-License-Identifier: Apache-2.0
// Smoothness (thesis 3.6): the finite difference of any blocks over q + 1 neighbouring stages.
//
//   E^d = sum_i h || D^q [x_i ... x_{i+q}] / h^q ||^2
//
// Divided by h^q and weighted by h, so that a weight means the same for any number of stages
// (reading 3.3). Where legs have steps of their own, divided differences take the place of finite
// ones: q! x[t_i, ..., t_{i+q}], inputs standing in the middle of the intervals they are held over.
//
//   p:add_cost { type = "derivative", block = "position", order = 4, weight = 1e-3 }
#include <sstream>

#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

class Derivative final : public DifferentiableCost<Derivative, 8> {
 public:
  static constexpr PluginText kText{"derivative", "1.0.0", "penalises a time derivative of a block",
                                    "thesis 3.5.2, (3.6)"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .text("block", "position", "penalised block; several separated by blanks")
        .integer("order", 4, "order of the derivative: 3 is jerk, 4 is snap", between(1, 4))
        .tables("except", time_span_table(), "spans without this cost: cuts");
  }
  static std::vector<Preset> presets() {
    const auto of = [](const char* block, int order) {
      Value defaults = Value::map();
      defaults.set("block", block);
      defaults.set("order", order);
      return defaults;
    };
    return {
        {"yaw_derivative", "penalises a derivative of yaw over time", of("yaw", 2)},
        {"gimbal_derivative", "penalises a derivative of the gimbal's angles, E^g",
         of("gimbal_yaw gimbal_pitch", 2)},
        {"target_derivative", "penalises a derivative of the target, E^{t,d}", of("target", 3)}};
  }

  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTranslation, nullptr},
                                    {kInvariantToRotationAboutZ, nullptr},
                                    {kInvariantToTime, nullptr}};
    return all;
  }
  explicit Derivative(const Parameters& parameters)
      : order_(static_cast<int>(parameters.integer("order"))),
        except_(time_spans(parameters, "except")) {
    std::istringstream names(parameters.text("block"));
    for (std::string name; names >> name;) {
      if (std::find(names_.begin(), names_.end(), name) != names_.end())
        throw InputError(parameters.origin("block"), "block: '" + name + "' is given twice");
      names_.push_back(name);
    }
    if (names_.empty())
      throw InputError(parameters.origin("block"), "block: expected the name of a block");
  }

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{
        .blocks = {}, .window = order_ + 1, .integral = true, .affine = !setting.horizon.step_free};
    even_ = setting.horizon.uniform();
    read_.clear();
    BlocksRead reads(setting.layout, shape.blocks);
    for (const std::string& name : names_) {
      const AnyHandle block = reads.add<Eigen::Dynamic>(name);
      const BlockRole role = setting.layout.block(shape.blocks.back()).role;
      read_.push_back({block, role == BlockRole::input});
      shape.rows += block.size();
    }
    step_ = reads.add("step");
    ask_within(shape, setting.horizon, {}, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    static constexpr double kBinomial[5][5] = {
        {}, {-1, 1}, {1, -2, 1}, {-1, 3, -3, 1}, {1, -4, 6, -4, 1}};
    if (!even_) return divided(stage, rows);
    T scale = 1.0;
    for (int q = 0; q < order_; ++q) scale = scale / stage(step_);
    int row = 0;
    for (const ReadBlock& read : read_)
      for (int i = 0; i < read.block.size(); ++i, ++row) {
        T sum = 0.0;
        for (int q = 0; q <= order_; ++q) sum += kBinomial[order_][q] * stage[q](read.block)[i];
        rows[row] = scale * sum;
      }
  }

 private:
  template <class T>
  void divided(const Stage<T>& stage, Rows<T>& rows) const {
    int row = 0;
    for (const ReadBlock& read : read_) {
      T times[5];
      times[0] = 0.0;
      for (int q = 0; q < order_; ++q) {
        const T& step = stage[q](step_);
        times[q + 1] = times[q] + (read.held ? 0.5 * (step + stage[q + 1](step_)) : step);
      }
      for (int i = 0; i < read.block.size(); ++i, ++row) {
        T table[5];
        for (int q = 0; q <= order_; ++q) table[q] = stage[q](read.block)[i];
        for (int level = 1; level <= order_; ++level)
          for (int q = 0; q + level <= order_; ++q)
            table[q] = double(level) * (table[q + 1] - table[q]) / (times[q + level] - times[q]);
        rows[row] = table[0];
      }
    }
  }

  std::vector<std::string> names_;
  struct ReadBlock {
    AnyHandle block;
    bool held = false;  // over a step: an input
  };
  std::vector<ReadBlock> read_;
  NumberHandle step_;
  bool even_ = true;  // one step for all
  int order_;
  std::vector<TimeSpan> except_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Derivative)
