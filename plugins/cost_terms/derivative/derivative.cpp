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
#include <array>
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
    stride_ = 0;
    for (const int block : shape.blocks) stride_ += setting.layout.block(block).size;
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

  // A row is linear in the blocks, sum_q w_q(h) x_q, with weights that depend on the steps alone.
  // Only these are differentiated twice, once for all numbers of a block.
  void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                 double* hessian, Workspace&) const override {
    const int width = stride_ * (order_ + 1);
    const auto step_at = [&](int q) { return q * stride_ + step_.offset(); };
    std::array<Weight, 5> weights[2];  // of states, of inputs
    for (int k = 0; k < range.count; ++k) {
      for (const bool held : {false, true}) weigh(inputs, held, weights[held]);
      for (const ReadBlock& read : read_) {
        const std::array<Weight, 5>& w = weights[read.held && !even_];
        for (int i = 0; i < read.block.size(); ++i, ++multipliers)
          for (int q = 0; q <= order_; ++q) {
            const int x = q * stride_ + read.block.offset() + i;
            for (int a = 0; a <= order_; ++a) {
              hessian[x * width + step_at(a)] += *multipliers * w[q].d[a].v;
              hessian[step_at(a) * width + x] += *multipliers * w[q].d[a].v;
              for (int b = 0; b <= order_; ++b)
                hessian[step_at(a) * width + step_at(b)] +=
                    *multipliers * inputs[x] * w[q].d[a].d[b];
            }
          }
      }
      inputs += width;
      hessian += static_cast<std::size_t>(width) * width;
    }
  }

 private:
  using Weight = Dual<Dual<double, 5>, 5>;  // in the steps of the window

  // What the numbers of a window are multiplied by.
  void weigh(const double* inputs, bool held, std::array<Weight, 5>& weights) const {
    std::array<Weight, 5> steps, times;
    for (int q = 0; q <= order_; ++q) {
      steps[q] = inputs[q * stride_ + step_.offset()];
      steps[q].v.d[q] = 1.0;
      steps[q].d[q] = Dual<double, 5>(1.0);
    }
    for (int q = 0; q < order_; ++q)
      times[q + 1] = times[q] + (even_  ? steps[0]
                                 : held ? 0.5 * (steps[q] + steps[q + 1])
                                        : steps[q]);
    static constexpr double kFactorial[5] = {1, 1, 2, 6, 24};
    for (int q = 0; q <= order_; ++q) {
      Weight apart = 1.0;
      for (int i = 0; i <= order_; ++i)
        if (i != q) apart *= times[q] - times[i];
      weights[q] = kFactorial[order_] / apart;
    }
  }

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
  int stride_ = 0;    // numbers of a stage of the window
  int order_;
  std::vector<TimeSpan> except_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Derivative)
