// SPDX-License-Identifier: Apache-2.0
// The thesis's approximate quadrotor: a point mass with yaw (3.1 to 3.3), exact zero-order hold.
//
//   m r'' = F + m g        I_psi psi'' = M_psi
//   r+ = r + h v + h^2/2 a      v+ = v + h a      a = F/m + g
//
//   p:add_model { type = "quadrotor" }
#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

class Quadrotor final : public DifferentiableModel<Quadrotor, 8, 4> {
 public:
  static constexpr PluginText kText{"quadrotor", "1.0.0",
                                    "point mass with yaw, inputs held over a step",
                                    "thesis 3.5.1, (3.1) to (3.3)"};
  static ParameterTable parameters() { return {}; }
  explicit Quadrotor(const Parameters&) {}

  void bind(const Vehicle& vehicle) override {
    if (!vehicle.has_rotors)
      throw InputError("vehicle '" + vehicle.name +
                       "' states no rotors, which the model 'quadrotor' needs: its file "
                       "needs inertia and rotors, or use another model, such as 'velocity'");
    mass_ = vehicle.mass;
    yaw_inertia_ = vehicle.inertia.z();
  }

  std::vector<BlockSpec> blocks() const override {
    return {{.name = "position", .size = 3, .unit = "m"},
            {.name = "yaw", .size = 1, .unit = "rad"},
            {.name = "velocity", .size = 3, .unit = "m/s"},
            {.name = "yaw_rate", .size = 1, .unit = "rad/s"},
            {.name = "force", .size = 3, .unit = "N", .role = BlockRole::input},
            {.name = "yaw_torque", .size = 1, .unit = "N m", .role = BlockRole::input}};
  }

  bool affine() const override { return true; }

  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    const T half_squared = 0.5 * step * step;
    for (int i = 0; i < 4; ++i) {
      const T acceleration = i < 3 ? input[i] * (1.0 / mass_) - (i == 2 ? kGravity : 0.0)
                                   : input[3] * (1.0 / yaw_inertia_);
      next[i] = state[i] + step * state[4 + i] + half_squared * acceleration;
      next[4 + i] = state[4 + i] + step * acceleration;
    }
  }

  // Twice differentiable in the step and what it multiplies alone.
  void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                 double* hessian, Workspace&) const override {
    constexpr int kInputs = 13, kStep = 12;
    for (int k = 0; k < range.count; ++k) {
      const double* const at = inputs + k * kInputs;
      const double* const multiplier = multipliers + k * 8;
      double* const h = hessian + k * kInputs * kInputs;
      const auto add = [&](int i, double value) {
        h[i * kInputs + kStep] += value;
        h[kStep * kInputs + i] += value;
      };
      for (int i = 0; i < 4; ++i) {
        const double inverse = 1.0 / (i < 3 ? mass_ : yaw_inertia_);
        const double acceleration = at[8 + i] * inverse - (i == 2 ? kGravity : 0.0);
        add(4 + i, multiplier[i]);
        add(8 + i, inverse * (multiplier[i] * at[kStep] + multiplier[4 + i]));
        h[kStep * kInputs + kStep] += multiplier[i] * acceleration;
      }
    }
  }

  void to_sample(const double* numbers, Sample& sample) const override {
    sample.position = Eigen::Vector3d(numbers);
    sample.yaw = numbers[3];
    sample.velocity = Eigen::Vector3d(numbers + 4);
    sample.yaw_rate = numbers[7];
    const Eigen::Vector3d force(numbers + 8);
    sample.columns.set("force", force);
    sample.columns.set("yaw_torque", numbers[11]);
    sample.acceleration = force / mass_ - kGravity * Eigen::Vector3d::UnitZ();
  }

  void from_sample(const Sample& sample, double* numbers) const override {
    Eigen::Map<Eigen::Vector3d>(numbers + 0) = sample.position;
    numbers[3] = sample.yaw;
    Eigen::Map<Eigen::Vector3d>(numbers + 4) = sample.velocity;
    numbers[7] = sample.yaw_rate;
    Eigen::Map<Eigen::Vector3d>(numbers + 8) =
        sample.columns.has("force") ? sample.columns.vector3("force")
                                    : Eigen::Vector3d(0, 0, mass_ * kGravity);  // it hovers
    numbers[11] = sample.columns.scalar("yaw_torque");
  }

  // The limits of the vehicle are constraints of their own: input_limits, state_limits.
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 12, -std::numeric_limits<double>::infinity());
    std::fill_n(upper, 12, std::numeric_limits<double>::infinity());
  }

  void describe(Trajectory& trajectory) const override {
    trajectory.motion = force_motion();
    trajectory.inputs_held = true;
  }

 private:
  double mass_ = 1.0, yaw_inertia_ = 1.0;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Quadrotor)
