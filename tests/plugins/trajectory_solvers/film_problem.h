// SPDX-License-Identifier: Apache-2.0
// Small films for tests of trajectory solvers, with the shipped camera drone.
#pragma once

#include <gtest/gtest.h>

#include "framework/config/shipped.h"
#include "framework/config/yaml.h"
#include "framework/plugin/registry.h"
#include "framework/solve/trajectory_solver.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"
#include "framework/verify/verify.h"

namespace lapwing {

inline const Registry& built_plugins() {
  static const Registry registry(
      std::vector<std::filesystem::path>{std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  return registry;
}

inline Vehicle solo() {
  const auto configs = shipped_folder("configs");
  const Value file = read_yaml(configs / "vehicles/solo.yaml");
  const Value camera = read_yaml(configs / "cameras/action.yaml");
  return vehicle_from(check(vehicle_table(), file), check(camera_table(), camera), "solo");
}

struct Film {
  std::vector<KeyframeTask> keyframes;
  double duration = 10;
  double step = 0.1;
  bool hard = false;  // keyframes as constraints, without tolerance
  bool norm = false;  // the force's norm itself: a curved constraint
};

inline Value table(std::initializer_list<std::pair<const char*, Value>> entries) {
  Value map = Value::map();
  for (const auto& [key, value] : entries) map.set(key, value);
  return map;
}

inline TrajectoryProblem problem_of(const Film& film) {
  const Registry& registry = built_plugins();
  const int stages = static_cast<int>(std::lround(film.duration / film.step)) + 1;
  TrajectoryProblem problem(solo(), {.stages = stages, .step = film.duration / (stages - 1)});
  problem.add_model("quadrotor", registry.create<VehicleModel>("quadrotor"));
  Value list = Value::list();
  std::vector<double> times, yaws;
  std::vector<Eigen::Vector3d> positions;
  for (const KeyframeTask& k : film.keyframes) {
    const Eigen::Vector3d& p = k.position;
    list.push_back(table({{"time", k.time}, {"value", Value::List{p.x(), p.y(), p.z()}}}));
    times.push_back(k.time);
    positions.push_back(p);
    yaws.push_back(0.0);
  }
  const Value keyframes = table({{"keyframes", list}});
  if (film.hard)
    problem.add_constraint("hard_keyframe",
                           registry.create<Constraint>("hard_keyframe", keyframes));
  else
    problem.add_cost("keyframe", 1000.0, registry.create<CostTerm>("keyframe", keyframes));
  problem.add_cost("snap", 1e-3, registry.create<CostTerm>("derivative", table({{"order", 4}})));
  // Differences of positions alone do not see forces that alternate from stage to stage.
  problem.add_cost(
      "calm", 1e-5,
      registry.create<CostTerm>("derivative", table({{"block", "force"}, {"order", 1}})));
  problem.add_cost("yaw", 1.0, registry.create<CostTerm>("yaw_derivative"));
  problem.add_constraint("input_limits",
                         registry.create<Constraint>("input_limits", table({{"norm", film.norm}})));
  problem.add_constraint("state_limits", registry.create<Constraint>("state_limits"));
  problem.add_constraint(
      "boundary_state", registry.create<Constraint>("boundary_state", table({{"start_yaw", 0.0}})));
  problem.set_path_guess(times, positions, yaws);
  problem.finish();
  return problem;
}

inline Certificate certify(const Film& film, const TrajectoryProblem& problem,
                           const SolveResult& result) {
  Plan plan;
  plan.mission = "test";
  plan.kind = "film";
  plan.vehicle = to_value(problem.vehicle());
  plan.trajectory = problem.trajectory(result.point.stages);
  plan.task.keyframes = film.keyframes;
  return verify(plan);
}

inline KeyframeTask keyframe(double time, Eigen::Vector3d position) {
  KeyframeTask result;
  result.time = time;
  result.position = std::move(position);
  return result;
}

inline Film crossing() {
  return {
      .keyframes = {keyframe(0, {0, 0, 2}), keyframe(3.33, {6, 2, 5}), keyframe(10, {10, -4, 3})}};
}

}  // namespace lapwing
