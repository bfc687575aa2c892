// SPDX-License-Identifier: Apache-2.0
// Effort: how far the inputs are from hovering (thesis 3.5.2, "wasted effort").
//
//   E^u = sum_i h ( || (F_i - m g e_z) / (m g) ||^2 + (M_i / M_max)^2 )
//
// Force is measured in weights and yaw torque in the vehicle's largest, so that one weight serves
// every vehicle; a vehicle that keeps no yaw moment (yaw_share = 0) has no second part.
//
//   p:add_cost { type = "input_effort", weight = 0.1 }
#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"

namespace lapwing {
namespace {

class InputEffort final : public DifferentiableCost<InputEffort, 4> {
 public:
  static constexpr PluginText kText{"input_effort", "1.0.0",
                                    "penalises inputs that differ from hovering", "thesis 3.5.2"};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTranslation, nullptr},
                                    {kInvariantToRotationAboutZ, nullptr},
                                    {kInvariantToTime, nullptr}};
    return all;
  }
  explicit InputEffort(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    weight_ = setting.vehicle.mass * kGravity;
    torque_max_ = setting.vehicle.yaw_torque_max();
    FunctionShape shape{
        .rows = 4, .integral = true, .affine = true, .row_names = {"x", "y", "z", "yaw"}};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("force"), reads.add("yaw_torque")};
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto force = stage(in_.force);
    rows[0] = force.x() / weight_;
    rows[1] = force.y() / weight_;
    rows[2] = force.z() / weight_ - 1.0;
    if (torque_max_ > 0) rows[3] = stage(in_.yaw_torque) / torque_max_;
  }

 private:
  struct {
    VectorHandle force;
    NumberHandle yaw_torque;
  } in_;
  double weight_ = 1, torque_max_ = 0;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::InputEffort)
