// SPDX-License-Identifier: Apache-2.0
// A drone that its own flight control moves: position and yaw are commanded, and limits of speed,
// acceleration and jerk say what it follows. Nothing is known of its thrust.
//
//   r' = v,   v' = a,   a' = jerk,   psi' = yaw rate,   jerk and yaw rate held over a step
//
//   p:add_model { type = "velocity" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Velocity final : public DifferentiableModel<Velocity, 10, 4> {
 public:
  static constexpr PluginText kText{
      "velocity", "1.0.0", "position and yaw as commands, with the limits that manufacturers state",
      "own"};
  static ParameterTable parameters() {
    return ParameterTable{}.number("share", 0.98, "",
                                   "used fraction of the limits of jerk and yaw rate",
                                   {.minimum = 0, .maximum = 1, .minimum_excluded = true});
  }
  explicit Velocity(const Parameters& parameters) : share_(parameters.number("share")) {}

  void bind(const Vehicle& vehicle) override {
    // A cube within the ball of the norm: any jerk of it is one that the vehicle can make.
    jerk_ = share_ * vehicle.jerk_max.value_or(kInfinity) / std::numbers::sqrt3;
    yaw_rate_ = share_ * vehicle.yaw_rate_max;
  }

  std::vector<BlockSpec> blocks() const override {
    return {{.name = "position", .size = 3, .unit = "m"},
            {.name = "yaw", .size = 1, .unit = "rad"},
            {.name = "velocity", .size = 3, .unit = "m/s"},
            {.name = "acceleration", .size = 3, .unit = "m/s^2"},
            {.name = "jerk", .size = 3, .unit = "m/s^3", .role = BlockRole::input},
            {.name = "yaw_rate", .size = 1, .unit = "rad/s", .role = BlockRole::input}};
  }

  bool affine() const override { return true; }

  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    const T *position = state, *velocity = state + 4, *acceleration = state + 7, *jerk = input;
    for (int i = 0; i < 3; ++i) {
      next[i] = position[i] +
                step * (velocity[i] + step * (0.5 * acceleration[i] + step * jerk[i] * (1.0 / 6)));
      next[4 + i] = velocity[i] + step * (acceleration[i] + 0.5 * step * jerk[i]);
      next[7 + i] = acceleration[i] + step * jerk[i];
    }
    next[3] = state[3] + step * input[3];
  }

  void to_sample(const double* x, Sample& sample) const override {
    sample.position = Eigen::Vector3d(x);
    sample.yaw = x[3];
    sample.velocity = Eigen::Vector3d(x + 4);
    sample.acceleration = Eigen::Vector3d(x + 7);
    sample.columns.set("jerk", Eigen::Vector3d(x + 10));
    sample.yaw_rate = x[13];
  }

  void from_sample(const Sample& sample, double* x) const override {
    Eigen::Map<Eigen::Vector3d>(x + 0) = sample.position;
    x[3] = sample.yaw;
    Eigen::Map<Eigen::Vector3d>(x + 4) = sample.velocity;
    Eigen::Map<Eigen::Vector3d>(x + 7) = sample.acceleration;
    Eigen::Map<Eigen::Vector3d>(x + 10) = sample.columns.vector3("jerk");
    x[13] = sample.yaw_rate;
  }

  // Speeds and accelerations are a constraint of their own: state_limits.
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 14, -kInfinity);
    std::fill_n(upper, 14, kInfinity);
    for (int i = 10; i < 13; ++i) lower[i] = -jerk_, upper[i] = jerk_;
    lower[13] = -yaw_rate_, upper[13] = yaw_rate_;
  }

  void describe(Trajectory& trajectory) const override {
    trajectory.motion = {.name = "velocity",
                         .columns = {{"jerk", "m/s^3", 3, true}},
                         .tracked = Tracking::acceleration};
    trajectory.inputs_held = true;
  }

 private:
  double share_, jerk_ = kInfinity, yaw_rate_ = kInfinity;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Velocity)
