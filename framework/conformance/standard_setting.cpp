// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/standard_setting.h"

#include <cmath>
#include <map>
#include <numbers>

#include "framework/core/units.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

// What plugins are checked with needs no plugin: a ball and a block.
class StandardBall final : public DifferentiableShape<StandardBall> {
 public:
  StandardBall(const Eigen::Vector3d& center, double radius) : center_(center), radius_(radius) {}
  template <class T>
  T core(const T* p) const {
    using std::sqrt;
    T squared = T(0.0);
    for (int i = 0; i < 3; ++i) squared += (p[i] - center_(i)) * (p[i] - center_(i));
    constexpr double kCentre = 1e-8;  // m^2
    if (value_of(squared) < kCentre) return p[2] - value_of(p[2]) + 1e-4;
    return sqrt(squared);
  }
  double rounding() const override { return radius_; }
  std::optional<SimpleForm> simple_form() const override {
    return SimpleForm{center_, Eigen::Vector3d::Constant(radius_), true};
  }
  Eigen::AlignedBox3d bounds() const override {
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(radius_);
    return {center_ - around, center_ + around};
  }
  TriangleMesh triangles(double tolerance, const Eigen::AlignedBox3d&) const override {
    const int chords = chords_of(radius_, tolerance / 2);
    std::vector<Eigen::Vector2d> profile{{0, -radius_}};
    for (int k = 1; k < chords; ++k)
      profile.emplace_back(radius_ * std::sin(std::numbers::pi * k / chords),
                           -radius_ * std::cos(std::numbers::pi * k / chords));
    profile.emplace_back(0, radius_);
    return turned_surface(profile, chords, center_);
  }
  Value record() const override { return Value::map(); }

 private:
  Eigen::Vector3d center_;
  double radius_;
};

class StandardBlock final : public DifferentiableShape<StandardBlock> {
 public:
  StandardBlock(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper, bool convex = true)
      : box_(lower, upper), convex_(convex) {}
  template <class T>
  T core(const T* p) const {
    using std::max, std::sqrt;
    T deepest = T(-1e9), squared = T(0.0);
    for (int i = 0; i < 3; ++i) {
      const T beyond = max(p[i] - box_.max()(i), box_.min()(i) - p[i]);
      deepest = max(deepest, beyond);
      if (value_of(beyond) > 0) squared += beyond * beyond;
    }
    return value_of(deepest) <= 0 ? deepest : sqrt(squared);
  }
  bool convex() const override { return convex_; }
  Eigen::AlignedBox3d bounds() const override { return box_; }
  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override {
    return box_surface(box_);
  }
  Value record() const override { return Value::map(); }

 private:
  Eigen::AlignedBox3d box_;
  bool convex_;
};

Obstacle obstacle_of(const char* name, std::shared_ptr<const Shape> shape,
                     Side side = Side::keep_out) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.type = "standard";
  obstacle.side = side;
  obstacle.shape = std::move(shape);
  return obstacle;
}

struct Plausible {
  double middle = 0, spread = 1;
};

Plausible plausible(const StandardSetting& standard, const BlockSpec& block, int component) {
  static const std::map<std::string, double> kSpreads{
      {"position", 20}, {"target", 20},       {"yaw", 3},          {"velocity", 3},
      {"force", 3},     {"yaw_torque", 0.05}, {"gimbal_pitch", 1}, {"rotor_thrusts", 2}};
  const auto found = kSpreads.find(block.name);
  Plausible result{0, found == kSpreads.end() ? 1.0 : found->second};
  const double weight = standard.vehicle.mass * kGravity;
  if (block.name == "force" && component == 2) result.middle = weight;
  if (block.name == "rotor_thrusts") result.middle = weight / 4;
  return result;
}

// Places some hundred metres away, motion a few times as fast.
double far_spread(double spread) {
  return spread >= 20 ? 15 * spread : 4 * spread;
}

}  // namespace

Vehicle standard_vehicle() {
  Vehicle vehicle;
  vehicle.name = "solo";
  vehicle.mass = 1.5;
  vehicle.inertia = {0.015, 0.015, 0.025};
  vehicle.rotors.thrust_max = 8.0;
  vehicle.rotors.thrust_min = 0.2;
  vehicle.rotors.torque_coefficient = 0.016;
  vehicle.rotors.arm_length = 0.23;
  vehicle.rotors.diagonal = true;
  vehicle.yaw_share = 0.2;
  vehicle.speed_across_max = 10;
  vehicle.climb_speed_max = 2.5;
  vehicle.descent_speed_max = 2;
  vehicle.acceleration_across_max = 4;
  vehicle.yaw_rate_max = radians(90);
  vehicle.flight_time = 1200;
  vehicle.jerk_max = 20;
  // Rotors and a wing at once, so that models of either find what they need.
  vehicle.wing = Wing{5, radians(20), radians(60), -3, 3};
  GimbalLimits gimbal;
  gimbal.pitch_min = radians(-90);
  gimbal.pitch_rate_max = radians(90);
  vehicle.gimbal = gimbal;
  vehicle.camera = {"action", 3840, 2160, 2300, 2300, 1919.5, 1079.5};
  return vehicle;
}

Environment standard_environment() {
  Environment environment;
  using Eigen::Vector3d;
  const auto ball = [](double x, double y, double z, double radius) {
    return std::make_shared<StandardBall>(Vector3d(x, y, z), radius);
  };
  const auto block = [](const Vector3d& lower, const Vector3d& upper, bool convex = true) {
    return std::make_shared<StandardBlock>(lower, upper, convex);
  };
  environment.obstacles = {
      obstacle_of("", ball(0, 0, 0, 4)),
      obstacle_of("dome", ball(-9, 6, 2, 7)),
      obstacle_of("", block({-3, -3, -2}, {3, 5, 2})),
      obstacle_of("tower", block({6, -12, 0}, {12, -4, 15})),
      obstacle_of("kite", ball(2, -7, 3, 2)),
      obstacle_of("", block({-30, -30, -30}, {30, 30, 30}), Side::keep_inside),
      obstacle_of("yard", block({-25, -25, -9}, {25, 25, 40}, false), Side::keep_inside)};
  Obstacle& kite = environment.obstacles[4];
  kite.times = {0.15, 0.55, 1.25};
  kite.moves = {{0, 0, 0}, {0.4, 0, 0.2}, {0.4, 1, 0.2}};
  kite.tolerance = 0.01;
  environment.obstacles[2].opaque = false;
  environment.subjects = {
      {"walker", {0.15, 0.55, 1.25}, {{1, 2, 1}, {2, 2, 1}, {2, 4, 3}}, 1.8, 0.6},
      {"point", {0.0}, {{-4, 5, 0}}}};
  environment.margin = 0.5;
  return environment;
}

StandardSetting::StandardSetting(bool step_free)
    : horizon{.stages = 8, .step = 0.2, .step_free = step_free},
      vehicle(standard_vehicle()),
      environment(standard_environment()) {
  const auto add = [&](const char* name, int size, BlockRole role,
                       Topology topology = Topology::line) {
    layout.add({.name = name, .size = size, .role = role, .topology = topology});
  };
  for (const auto& [name, size] : {std::pair{"position", 3},
                                   {"yaw", 1},
                                   {"velocity", 3},
                                   {"yaw_rate", 1},
                                   {"gimbal_yaw", 1},
                                   {"gimbal_pitch", 1},
                                   {"body_rates", 3}})
    add(name, size, BlockRole::state);
  add("orientation", 4, BlockRole::state, Topology::quaternion);
  for (const auto& [name, size] : {std::pair{"force", 3},
                                   {"yaw_torque", 1},
                                   {"rotor_thrusts", 4},
                                   {"gimbal_yaw_rate", 1},
                                   {"gimbal_pitch_rate", 1}})
    add(name, size, BlockRole::input);
  add("target", 3, BlockRole::free);
  add("time", 1, BlockRole::clock);
  add("step", 1, BlockRole::clock);
}

StandardSetting StandardSetting::long_flight() {
  StandardSetting setting(false);
  setting.horizon.stages = 3001;
  return setting;
}

Instances instances_of(const FunctionShape& shape, const Horizon& horizon) {
  Instances result{shape.times};
  if (!shape.times.empty()) return result;
  for (const int stage : shape.stages) result.times.push_back(stage * horizon.step);
  if (!shape.stages.empty()) return result;
  for (int stage = 0; stage + shape.window <= horizon.stages; ++stage)
    result.times.push_back(stage * horizon.step);
  return result;
}

std::vector<InputPlace> input_places(const FunctionShape& shape, const StageLayout& layout) {
  std::vector<InputPlace> result;
  for (int w = 0; w < shape.window; ++w)
    for (const int block : shape.blocks)
      for (int i = 0; i < layout.block(block).size; ++i) result.push_back({w, block, i});
  return result;
}

std::vector<double> make_inputs(const StandardSetting& standard, const FunctionShape& shape,
                                const std::vector<double>& times, InputKind kind, Random& random) {
  const std::vector<InputPlace> places = input_places(shape, standard.layout);
  const std::size_t per_stage = places.size() / shape.window;
  const bool by_chance = kind == InputKind::random || kind == InputKind::far;
  const bool free_clock = standard.horizon.step_free && by_chance;
  std::vector<double> result;
  result.reserve(times.size() * places.size());
  for (const double instance : times) {
    const double step = free_clock ? random.uniform(0.1, 0.4) : standard.horizon.step;
    const double time = free_clock ? instance * random.uniform(0.5, 2) : instance;
    const std::size_t first = result.size();
    Eigen::Vector4d turn(1, 0, 0, 0);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const BlockSpec& block = standard.layout.block(places[k].block);
      const Plausible range = plausible(standard, block, places[k].component);
      const double spread = kind == InputKind::far ? far_spread(range.spread) : range.spread;
      double value = range.middle + spread * random.uniform(-1, 1);
      if (kind == InputKind::zero) value = 0;
      if (block.topology == Topology::quaternion) {
        if (kind != InputKind::zero && places[k].component == 0) {
          for (double& x : turn) x = random.normal();
          turn.normalize();
        }
        value = turn[places[k].component];
      }
      if (kind == InputKind::coincident && places[k].stage > 0)
        value = result[first + k % per_stage];
      if (block.name == "step") value = step;
      if (block.name == "time") value = time + places[k].stage * step;
      result.push_back(value);
    }
  }
  return result;
}

}  // namespace lapwing
