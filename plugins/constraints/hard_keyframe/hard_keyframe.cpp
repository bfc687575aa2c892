// Keyframes that must be met: a block at given times, within a tolerance.
//
//   | block_k(t_j) - value_jk | <= tolerance / sqrt(n),   k = 1..n
//
// The box lies inside the ball, so that the distance itself stays within the tolerance; tolerance 0
// is an equation. Times are exact: between two stages the kernel reads the block off the vehicle
// model's flow (reading 3.1).
//
//   p:add_constraint { type = "hard_keyframe", tolerance = 0.5,
//                      keyframes = { { time = 2.5, value = {0, 0, 3} } } }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

class HardKeyframe final : public DifferentiableConstraint<HardKeyframe> {
 public:
  static constexpr PluginText kText{"hard_keyframe", "1.0.0",
                                    "a block must be near values at given times",
                                    "thesis 3.5.2, (3.4) as a constraint"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .text("block", "position", "block that must be there: position, yaw, target, ...")
        .number("tolerance", 0.0, "", "largest distance allowed, in the block's unit", at_least(0))
        .tables("keyframes",
                ParameterTable{}
                    .required_number("time", "s", "when, from the start; need not be on a stage",
                                     at_least(0))
                    .required_numbers("value", 0, "", "where to be, in the block's unit"),
                "what to pass, and when; at least one", true);
  }

  explicit HardKeyframe(const Parameters& parameters)
      : block_(parameters.text("block")), tolerance_(parameters.number("tolerance")) {
    for (const Parameters& given : parameters.tables("keyframes")) {
      const auto value = given.numbers("value");
      times_.push_back(given.number("time"));
      values_.emplace_back(value.begin(), value.end());
    }
    if (times_.empty())
      throw InputError(parameters.origin("keyframes"), "keyframes: expected at least one");
  }

  FunctionShape declare(const ProblemSetting& setting) {
    const BlockSpec& block = setting.layout.block(setting.layout.index(block_));
    if (block.topology != Topology::line)
      throw InputError("block '" + block_ + "' is an orientation, which keyframes cannot hold");
    for (std::size_t j = 0; j < values_.size(); ++j)
      if (static_cast<int>(values_[j].size()) != block.size)
        throw InputError("keyframe " + std::to_string(j + 1) + " has " +
                         std::to_string(values_[j].size()) + " numbers, block '" + block_ +
                         "' has " + std::to_string(block.size));
    size_ = block.size;
    FunctionShape shape{.blocks = setting.layout.indices({block_}),
                        .rows = size_,
                        .times = times_,
                        .affine = true,
                        .identity = true};
    for (int i = 0; i < size_; ++i)
      shape.row_names.push_back(size_ == 1 ? block_ : component_name(block, i));
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    for (int i = 0; i < size_; ++i) rows[i] = stage.data(0)[i];
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    const double half = tolerance_ / std::sqrt(static_cast<double>(size_));
    for (int k = 0; k < range.count; ++k)
      for (int i = 0; i < size_; ++i) {
        const double value = values_[range.first + k][i];
        *lower++ = value - half;
        *upper++ = value + half;
      }
  }

 private:
  std::string block_;
  double tolerance_;
  std::vector<double> times_;
  std::vector<std::vector<double>> values_;
  int size_ = 0;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::HardKeyframe)
