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

namespace lapwing {
namespace {

class Keyframe final : public DifferentiableCost<Keyframe> {
 public:
  static constexpr PluginText kText{"keyframe", "1.0.0",
                                    "penalises the distance of a block from values at given times",
                                    "thesis 3.5.2, (3.4)"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .text("block", "position", "penalised block: position, yaw, target, ...")
        .tables("keyframes",
                ParameterTable{}
                    .required_number("time", "s", "time from the start; need not be on a stage",
                                     at_least(0))
                    .required_numbers("value", 0, "", "value, in the block's unit")
                    .number("weight", 1.0, "", "relative weight of this keyframe", at_least(0)),
                "times and values; at least one", true);
  }

  static std::vector<Preset> presets() {
    Value defaults = Value::map();
    defaults.set("block", "target");
    return {{"target_keyframe", "pulls the target to points at given times, E^t", defaults}};
  }

  explicit Keyframe(const Parameters& parameters) : block_(parameters.text("block")) {
    for (const Parameters& given : parameters.tables("keyframes")) {
      const auto value = given.numbers("value");
      times_.push_back(given.number("time"));
      values_.emplace_back(value.begin(), value.end());
      roots_.push_back(std::sqrt(given.number("weight")));
    }
    if (times_.empty())
      throw InputError(parameters.origin("keyframes"), "keyframes: expected at least one");
  }

  FunctionShape declare(const ProblemSetting& setting) {
    const BlockSpec& block = setting.layout.block(setting.layout.index(block_));
    if (block.topology != Topology::line)
      throw InputError("block '" + block_ + "' is an orientation, which keyframes cannot pull");
    for (std::size_t j = 0; j < values_.size(); ++j)
      if (static_cast<int>(values_[j].size()) != block.size)
        throw InputError("keyframe " + std::to_string(j + 1) + " has " +
                         std::to_string(values_[j].size()) + " numbers, block '" + block_ +
                         "' has " + std::to_string(block.size));
    size_ = block.size;
    return {
        .blocks = setting.layout.indices({block_}), .rows = size_, .times = times_, .affine = true};
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const int j = stage.instance();
    for (int i = 0; i < size_; ++i) rows[i] = roots_[j] * (stage.data(0)[i] - values_[j][i]);
  }

 private:
  std::string block_;
  std::vector<double> times_, roots_;
  std::vector<std::vector<double>> values_;
  int size_ = 0;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Keyframe)
