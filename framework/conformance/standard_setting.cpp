// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/standard_setting.h"

#include <cmath>
#include <map>

#include "framework/core/units.h"

namespace lapwing {
namespace {

// The distance to a ball, in place of what a file would hold.
class BallDistance final : public DistanceField {
 public:
  BallDistance(const Eigen::Vector3d& center, double radius) : center_(center), radius_(radius) {}
  double distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const override {
    const double away = (p_W - center_).norm();
    if (gradient)
      *gradient = away > 0 ? Eigen::Vector3d((p_W - center_) / away)
                           : Eigen::Vector3d(Eigen::Vector3d::Zero());
    return away - radius_;
  }
  double reach() const override { return 1e3; }

 private:
  Eigen::Vector3d center_;
  double radius_;
};

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
  environment.spheres = {{"", {0, 0, 0}, 4}, {"dome", {-9, 6, 2}, 7}};
  environment.boxes = {{"", {-3, -3, -2}, {3, 5, 2}}, {"tower", {6, -12, 0}, {12, -4, 15}}};
  environment.zones = {{"", {{0, 0}, {12, 1}, {13, 9}, {6, 4}, {2, 11}}},
                       {"field", {{-15, -15}, {-15, -2}, {-4, -9}}, -5, 8}};
  environment.flight_zones = {
      {"", {{-30, -30}, {30, -30}, {30, 30}, {-30, 30}}, -30, 30},
      {"yard", {{-25, -25}, {25, -25}, {25, 25}, {4, 25}, {4, 2}, {-25, 2}}, -9}};
  environment.meshes = {
      {"wall", "", "", std::make_shared<BallDistance>(Eigen::Vector3d(2, -7, 3), 2)}};
  environment.maps = {{"", "", "", std::make_shared<BallDistance>(Eigen::Vector3d(-6, 9, -2), 5)}};
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
