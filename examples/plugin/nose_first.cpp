// SPDX-License-Identifier: Apache-2.0
// The vehicle flies nose first: no speed sideways.
//
//   E = sum_i h (s_i / tolerance)^2,   s = v_y cos yaw - v_x sin yaw, m/s to the left
//
//   p:add_cost { type = "nose_first", tolerance = 0.5, weight = 1 }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

class NoseFirst final : public DifferentiableCost<NoseFirst, 4> {
 public:
  static constexpr PluginText kText{"nose_first", "1.0.0", "penalises flying sideways", "own"};
  static ParameterTable parameters() {
    return ParameterTable{}.number("tolerance", 0.5, "m/s", "speed sideways that costs 1",
                                   between(1e-3, 100));
  }
  explicit NoseFirst(const Parameters& parameters) : tolerance_(parameters.number("tolerance")) {}

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.rows = 1, .integral = true};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("velocity"), reads.add("yaw")};
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    using std::cos, std::sin;
    const auto velocity = stage(in_.velocity);
    const T& yaw = stage(in_.yaw);
    rows[0] = (velocity.y() * cos(yaw) - velocity.x() * sin(yaw)) * (1.0 / tolerance_);
  }

 private:
  double tolerance_;
  struct {
    VectorHandle velocity;
    NumberHandle yaw;
  } in_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::NoseFirst)
