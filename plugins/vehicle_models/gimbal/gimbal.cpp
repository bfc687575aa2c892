// SPDX-License-Identifier: Apache-2.0
// The camera's gimbal (thesis 3.5.3): two angles, turned by their rates.
//
//   psi_g' = u_psi,  phi_g' = u_phi,   held over a step;  limits of both from the vehicle
//
//   p:add_model { type = "quadrotor" }
//   p:add_model { type = "gimbal" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

class Gimbal final : public DifferentiableModel<Gimbal, 2, 2> {
 public:
  static constexpr PluginText kText{
      "gimbal", "1.0.0", "yaw and pitch of the camera, integrated from rates", "thesis 3.5.3"};
  static ParameterTable parameters() { return {}; }
  explicit Gimbal(const Parameters&) {}

  void bind(const Vehicle& vehicle) override {
    if (!vehicle.gimbal)
      throw InputError("vehicle '" + vehicle.name +
                       "' has no gimbal: its file needs a table 'gimbal', or the model 'gimbal' "
                       "must go");
    limits_ = *vehicle.gimbal;
  }

  std::vector<BlockSpec> blocks() const override {
    return {{.name = "gimbal_yaw", .unit = "rad"},
            {.name = "gimbal_pitch", .unit = "rad"},
            {.name = "gimbal_yaw_rate", .unit = "rad/s", .role = BlockRole::input},
            {.name = "gimbal_pitch_rate", .unit = "rad/s", .role = BlockRole::input}};
  }

  bool affine() const override { return true; }

  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    for (int i = 0; i < 2; ++i) next[i] = state[i] + step * input[i];
  }

  void to_sample(const double* numbers, Sample& sample) const override {
    sample.gimbal_yaw = numbers[0];
    sample.gimbal_pitch = numbers[1];
    sample.gimbal_yaw_rate = numbers[2];
    sample.gimbal_pitch_rate = numbers[3];
  }

  void from_sample(const Sample& sample, double* numbers) const override {
    numbers[0] = sample.gimbal_yaw;
    numbers[1] = sample.gimbal_pitch;
    numbers[2] = sample.gimbal_yaw_rate;
    numbers[3] = sample.gimbal_pitch_rate;
  }

  // An axis that cannot turn is held where it is by equal bounds.
  void bounds(double* lower, double* upper) const override {
    const double low[] = {limits_.yaw_min, limits_.pitch_min, -limits_.yaw_rate_max,
                          -limits_.pitch_rate_max};
    const double high[] = {limits_.yaw_max, limits_.pitch_max, limits_.yaw_rate_max,
                           limits_.pitch_rate_max};
    std::copy_n(low, 4, lower);
    std::copy_n(high, 4, upper);
  }

  void describe(Trajectory& trajectory) const override { trajectory.has_gimbal = true; }

 private:
  GimbalLimits limits_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Gimbal)
