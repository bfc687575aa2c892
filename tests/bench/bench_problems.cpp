// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bench_problems.h"

#include "framework/core/random.h"
#include "framework/solve/local_program.h"
#include "tests/camera_drone.h"

namespace lapwing {
namespace {

constexpr double kStep = 0.1;                      // s
constexpr double kKeyframeInterval = 30.0 / 11.0;  // s: 12 keyframes in 30 s

// With weaker rotors.
Vehicle drone() {
  Vehicle vehicle = camera_drone("bench");
  vehicle.inertia = {0.02, 0.02, 0.035};
  vehicle.rotors.thrust_max = 7.4;
  vehicle.rotors.diagonal = false;
  return vehicle;
}

Value term(std::initializer_list<std::pair<const char*, Value>> entries) {
  Value map = Value::map();
  for (const auto& [key, value] : entries) map.set(key, value);
  return map;
}

}  // namespace

TrajectoryProblem quadratic_flight(const Registry& registry, double seconds, std::uint64_t seed) {
  const int stages = static_cast<int>(std::lround(seconds / kStep));
  const Horizon horizon{.stages = stages, .step = seconds / (stages - 1)};
  TrajectoryProblem problem(drone(), horizon);
  problem.add_model("quadrotor", registry.create<VehicleModel>("quadrotor"));
  Random random(seed);
  const int count = static_cast<int>(std::lround(seconds / 30.0 * 12.0));
  std::vector<double> times, yaws(count, 0.0);
  std::vector<Eigen::Vector3d> positions;
  Value keyframes = Value::list();
  Eigen::Vector3d at(0, 0, 5);
  for (int k = 0; k < count; ++k) {
    times.push_back(std::min(k * kKeyframeInterval * seconds / (kKeyframeInterval * (count - 1)),
                             horizon.duration()));
    at += Eigen::Vector3d(random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-3, 3));
    positions.push_back(at);
    keyframes.push_back(
        term({{"time", times.back()}, {"value", Value::List{at.x(), at.y(), at.z()}}}));
  }
  problem.add_cost("keyframe", 10.0,
                   registry.create<CostTerm>("keyframe", term({{"keyframes", keyframes}})));
  problem.add_cost("snap", 1e-3, registry.create<CostTerm>("derivative", term({{"order", 4}})));
  problem.add_cost("yaw", 1e-2, registry.create<CostTerm>("yaw_derivative"));
  problem.add_constraint("input_limits", registry.create<Constraint>("input_limits"));
  problem.add_constraint("boundary_state", registry.create<Constraint>("boundary_state"));
  problem.set_path_guess(times, positions, yaws);
  problem.finish();
  return problem;
}

QuadraticProgram program_of(const TrajectoryProblem& problem) {
  LocalModel model;
  problem.linearise(problem.initial_guess(), model);
  return local_program(model);
}

}  // namespace lapwing
