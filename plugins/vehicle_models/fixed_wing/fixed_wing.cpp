// SPDX-License-Identifier: Apache-2.0
// A fixed-wing aircraft in still air, in coordinated turns (Beard, McLain, "Small Unmanned
// Aircraft", 2012, chapter 9): the heading is the course, and a bank turns it. With U the speed
// across, e the direction of (v_x, v_y), n = z x e, and b the acceleration across the course:
//
//   r' = v,   v' = a_f e + b n + a_w z,   psi' = b / U,   b' = j;      bank = atan(b / g)
//
// The inputs a_f, a_w and j are held over a step, which Runge-Kutta 4 integrates. The course of the
// velocity is psi at all times once it is at the start, which is a condition of the model. Others:
//
//   stall:   |v|^2 >= V_s^2 n,  n = sqrt(1 + (b/g)^2)   the load factor of a level turn
//   thrust:  lo <= (U a_f + v_z a_w + g v_z) / |v| <= hi   what thrust less drag gives a mass
//
//   p:add_model { type = "fixed_wing" }
#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What the model reads of a vehicle, as it uses it.
struct WingLimits {
  double stall_speed = 1, fastest = 1, lateral = 1, lateral_jerk = 1;
  double thrust_min = -1, thrust_max = 1, up = 1, down = 1;
};

// 1 / sqrt(s). Below `least`, which the stall forbids, its Taylor polynomial of second order, so
// that it has a value and two derivatives everywhere.
template <class T>
T inverse_root(const T& s, double least) {
  using std::sqrt;
  if (s >= least) return 1.0 / sqrt(s);
  const double root = 1 / std::sqrt(least);
  const T d = (s - least) * (1 / least);
  return root * (1.0 + d * (0.375 * d - 0.5));
}

// Thrust less drag over the mass, m/s^2: what changes the speed and the height.
template <class T, class Velocity>
T excess_thrust(const Velocity& v, const T& forward, const T& climb, double least) {
  const T across = v.x() * v.x() + v.y() * v.y(), all = across + v.z() * v.z();
  const T speed = across * inverse_root(across, least);
  return (speed * forward + v.z() * (climb + kGravity)) * inverse_root(all, least);
}

// One row each: airspeed above the stall, and both sides of the excess thrust.
class WingLimitRows final : public DifferentiableConstraint<WingLimitRows> {
 public:
  explicit WingLimitRows(const WingLimits& limits) : limits_(limits) {}

  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices(
                {"velocity", "lateral_acceleration", "forward_acceleration", "climb_acceleration"}),
            .rows = 2,
            .row_names = {"stall", "excess_thrust"}};
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    using std::sqrt;
    const auto v = stage.template vector<3>(0);
    const T tangent = stage.scalar(1) * (1 / kGravity);
    const T all = v.x() * v.x() + v.y() * v.y() + v.z() * v.z();
    const double stall = limits_.stall_speed * limits_.stall_speed;
    rows[0] = all * (1 / stall) - sqrt(1.0 + tangent * tangent);
    rows[1] = excess_thrust<T>(v, stage.scalar(2), stage.scalar(3), stall / 4);
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k) {
      *lower++ = 0, *upper++ = kInfinity;
      *lower++ = limits_.thrust_min, *upper++ = limits_.thrust_max;
    }
  }

 private:
  WingLimits limits_;
};

// The excess thrust at the end of each step: inputs are held over it while the speed changes.
class ThrustAtEnds final : public DifferentiableConstraint<ThrustAtEnds> {
 public:
  explicit ThrustAtEnds(const WingLimits& limits) : limits_(limits) {}

  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks =
                setting.layout.indices({"velocity", "forward_acceleration", "climb_acceleration"}),
            .window = 2,
            .rows = 1,
            .row_names = {"excess_thrust"}};
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    rows[0] = excess_thrust<T>(stage[1].template vector<3>(0), stage.scalar(1), stage.scalar(2),
                               limits_.stall_speed * limits_.stall_speed / 4);
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count, limits_.thrust_min);
    std::fill_n(upper, range.count, limits_.thrust_max);
  }

 private:
  WingLimits limits_;
};

// At the first stage the velocity points where the nose does.
class StartingCourse final : public DifferentiableConstraint<StartingCourse> {
 public:
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices({"velocity", "yaw"}),
            .rows = 2,
            .stages = {0},
            .row_names = {"across", "along"}};
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    using std::cos;
    using std::sin;
    const auto v = stage.template vector<3>(0);
    const T c = cos(stage.scalar(1)), s = sin(stage.scalar(1));
    rows[0] = v.y() * c - v.x() * s;
    rows[1] = v.x() * c + v.y() * s;
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    for (int k = 0; k < range.count; ++k) {
      *lower++ = 0, *upper++ = 0;
      *lower++ = 0, *upper++ = kInfinity;
    }
  }
};

class FixedWing final : public DifferentiableModel<FixedWing, 8, 3> {
 public:
  static constexpr PluginText kText{"fixed_wing", "1.0.0",
                                    "coordinated turns with limits of stall, bank and thrust",
                                    "Beard and McLain (2012), chapter 9"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .number("share", 0.98, "", "used fraction of bank, bank rate, thrust and accelerations",
                {.minimum = 0, .maximum = 1, .minimum_excluded = true})
        .number("stall_reserve", 1.05, "", "factor on the stall speed", between(1, 3));
  }
  explicit FixedWing(const Parameters& parameters)
      : share_(parameters.number("share")), reserve_(parameters.number("stall_reserve")) {}

  void bind(const Vehicle& vehicle) override {
    if (!vehicle.wing)
      throw InputError("vehicle '" + vehicle.name +
                       "' has no wing: the model 'fixed_wing' needs a table 'wing' in its file");
    const Wing& wing = *vehicle.wing;
    limits_.stall_speed = reserve_ * wing.stall_speed;
    limits_.fastest = vehicle.speed_across_max;
    // A turn takes less than the acceleration across, which the thrust along the course shares.
    limits_.lateral = share_ * kGravity * std::tan(wing.bank_max);
    limits_.lateral_jerk = share_ * kGravity * wing.bank_rate_max;
    limits_.thrust_min = share_ * wing.excess_thrust_min;
    limits_.thrust_max = share_ * wing.excess_thrust_max;
    limits_.up = share_ * vehicle.largest_acceleration_up();
    limits_.down = share_ * vehicle.largest_acceleration_down();
    const double most = share_ * vehicle.acceleration_across_max;
    forward_ = std::sqrt(std::max(0.0, most * most - limits_.lateral * limits_.lateral));
  }

  std::vector<BlockSpec> blocks() const override {
    return {{.name = "position", .size = 3, .unit = "m"},
            {.name = "velocity", .size = 3, .unit = "m/s"},
            {.name = "yaw", .size = 1, .unit = "rad"},
            {.name = "lateral_acceleration", .size = 1, .unit = "m/s^2"},
            {.name = "forward_acceleration", .unit = "m/s^2", .role = BlockRole::input},
            {.name = "climb_acceleration", .unit = "m/s^2", .role = BlockRole::input},
            {.name = "lateral_jerk", .unit = "m/s^3", .role = BlockRole::input}};
  }

  bool affine() const override { return false; }
  bool rests() const override { return false; }

  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    T k1[8], k2[8], k3[8], k4[8], x[8];
    rate(state, input, k1);
    for (int i = 0; i < 8; ++i) x[i] = state[i] + 0.5 * step * k1[i];
    rate(x, input, k2);
    for (int i = 0; i < 8; ++i) x[i] = state[i] + 0.5 * step * k2[i];
    rate(x, input, k3);
    for (int i = 0; i < 8; ++i) x[i] = state[i] + step * k3[i];
    rate(x, input, k4);
    for (int i = 0; i < 8; ++i)
      next[i] = state[i] + step * (1.0 / 6) * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  }

  void to_sample(const double* x, Sample& sample) const override {
    double change[8];
    rate(x, x + 8, change);
    sample.position = Eigen::Vector3d(x);
    sample.velocity = Eigen::Vector3d(x + 3);
    sample.acceleration = Eigen::Vector3d(change + 3);
    sample.yaw = x[6];
    sample.yaw_rate = change[6];
    sample.columns.set("lateral_acceleration", x[7]);
    sample.columns.set("forward_acceleration", x[8]);
    sample.columns.set("climb_acceleration", x[9]);
    sample.columns.set("lateral_jerk", x[10]);
  }

  // The velocity of a guess may be any; that of the model is fast enough, and along the heading.
  void from_sample(const Sample& sample, double* x) const override {
    Eigen::Map<Eigen::Vector3d>(x + 0) = sample.position;
    Eigen::Map<Eigen::Vector3d>(x + 3) = sample.velocity;
    x[6] = sample.yaw;
    x[7] = sample.columns.scalar("lateral_acceleration");
    x[8] = sample.columns.scalar("forward_acceleration");
    x[9] = sample.columns.scalar("climb_acceleration");
    x[10] = sample.columns.scalar("lateral_jerk");
    if (sample.columns.has("lateral_acceleration")) return;
    const double speed = std::clamp(sample.velocity.head<2>().norm(), 1.1 * limits_.stall_speed,
                                    std::max(1.1 * limits_.stall_speed, 0.9 * limits_.fastest));
    x[3] = speed * std::cos(x[6]);
    x[4] = speed * std::sin(x[6]);
  }

  // Speeds across, up and down are a constraint of their own: state_limits.
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 11, -kInfinity);
    std::fill_n(upper, 11, kInfinity);
    lower[7] = -limits_.lateral, upper[7] = limits_.lateral;
    lower[8] = -forward_, upper[8] = forward_;
    lower[9] = -limits_.down, upper[9] = limits_.up;
    lower[10] = -limits_.lateral_jerk, upper[10] = limits_.lateral_jerk;
  }

  std::vector<std::pair<std::string, std::unique_ptr<Constraint>>> conditions() const override {
    std::vector<std::pair<std::string, std::unique_ptr<Constraint>>> all;
    all.emplace_back("limits", std::make_unique<WingLimitRows>(limits_));
    all.emplace_back("thrust_at_ends", std::make_unique<ThrustAtEnds>(limits_));
    all.emplace_back("course", std::make_unique<StartingCourse>());
    return all;
  }

  void describe(Trajectory& trajectory) const override {
    trajectory.motion = {.name = "coordinated_turn",
                         .columns = {{"lateral_acceleration", "m/s^2", 1, false},
                                     {"forward_acceleration", "m/s^2", 1, true},
                                     {"climb_acceleration", "m/s^2", 1, true},
                                     {"lateral_jerk", "m/s^3", 1, true}}};
    trajectory.inputs_held = true;
  }

 private:
  template <class T>
  void rate(const T* x, const T* input, T* change) const {
    const double least = limits_.stall_speed * limits_.stall_speed / 4;
    const T inverse = inverse_root(T(x[3] * x[3] + x[4] * x[4]), least);
    const T east = x[3] * inverse, north = x[4] * inverse;
    for (int i = 0; i < 3; ++i) change[i] = x[3 + i];
    change[3] = input[0] * east - x[7] * north;
    change[4] = input[0] * north + x[7] * east;
    change[5] = input[1];
    change[6] = x[7] * inverse;
    change[7] = input[2];
  }

  double share_, reserve_, forward_ = 1;
  WingLimits limits_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::FixedWing)
