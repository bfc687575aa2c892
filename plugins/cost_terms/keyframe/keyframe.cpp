// SPDX-License-Identifier: Apache-2.0
// Keyframes to be met softly (thesis 3.5.2, (3.4)): a block at given times.
//
//   E^k = sum_j weight_j || block(t_j) - value_j ||^2
//
// Times are exact: between two stages the kernel reads the block off the vehicle model's flow
// (reading 3.1). Keyframes may come in any order, and several at one time pull together.
//
//   p:add_cost { type = "keyframe", weight = 10, keyframes = { { time = 2.5, value = {0, 0, 3} } }
//   }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/timed_values.h"

namespace lapwing {
namespace {

class Keyframe final : public DifferentiableCost<Keyframe> {
 public:
  static constexpr PluginText kText{"keyframe", "1.0.0",
                                    "penalises the distance of a block from values at given times",
                                    "thesis 3.5.2, (3.4)"};
  static ParameterTable parameters() {
    return TimedValues::table(
        "penalised", TimedValues::entry().number("weight", 1.0, "",
                                                 "relative weight of this keyframe", at_least(0)));
  }

  static std::vector<Preset> presets() {
    Value defaults = Value::map();
    defaults.set("block", "target");
    return {{"target_keyframe", "pulls the target to points at given times, E^t", defaults}};
  }

  explicit Keyframe(const Parameters& parameters) : wanted_(parameters) {
    for (const Parameters& given : parameters.tables("keyframes"))
      roots_.push_back(std::sqrt(given.number("weight")));
  }

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.affine = true};
    block_ = wanted_.bind(setting, shape, "pull");
    shape.rows = block_.size();
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const int j = stage.instance();
    const std::vector<double>& value = wanted_.value(j);
    const auto at = stage(block_);
    for (int i = 0; i < block_.size(); ++i) rows[i] = roots_[j] * (at[i] - value[i]);
  }

 private:
  TimedValues wanted_;
  std::vector<double> roots_;  // of the weights
  AnyHandle block_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Keyframe)
