// Smoothness (thesis 3.6): the finite difference of any block over q + 1 neighbouring stages.
//
//   E^d = sum_i h || D^q [x_i ... x_{i+q}] / h^q ||^2
//
// Divided by h^q and weighted by h, so that a weight means the same for any number of stages
// (reading 3.3).
//
//   p:add_cost { type = "derivative", block = "position", order = 4, weight = 1e-3 }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

class Derivative final : public DifferentiableCost<Derivative, 8> {
 public:
  static constexpr PluginText kText{
      "derivative", "1.0.0", "penalises a derivative of a block over time", "thesis 3.5.2, (3.6)"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .text("block", "position", "block whose derivative is penalised")
        .integer("order", 4, "order of the derivative: 3 is jerk, 4 is snap", between(1, 4));
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
         of("gimbal", 2)},
        {"target_derivative", "penalises a derivative of the target, E^{t,d}", of("target", 3)}};
  }

  explicit Derivative(const Parameters& parameters)
      : block_(parameters.text("block")), order_(static_cast<int>(parameters.integer("order"))) {}

  FunctionShape declare(const ProblemSetting& setting) {
    size_ = setting.layout.block(setting.layout.index(block_)).size;
    return {.blocks = setting.layout.indices({block_, "step"}),
            .window = order_ + 1,
            .rows = size_,
            .integral = true,
            .affine = !setting.horizon.step_free};
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    static constexpr double kBinomial[5][5] = {
        {}, {-1, 1}, {1, -2, 1}, {-1, 3, -3, 1}, {1, -4, 6, -4, 1}};
    T scale = 1.0;
    for (int q = 0; q < order_; ++q) scale = scale / stage.scalar(1);
    for (int i = 0; i < size_; ++i) {
      T sum = 0.0;
      for (int q = 0; q <= order_; ++q) sum += kBinomial[order_][q] * stage[q].data(0)[i];
      rows[i] = scale * sum;
    }
  }

 private:
  std::string block_;
  int order_;
  int size_ = 0;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Derivative)
