// SPDX-License-Identifier: Apache-2.0
// What tests of cost terms and constraints bind them to.
#pragma once

#include "framework/core/units.h"
#include "framework/plugin/registry.h"
#include "framework/problem/trajectory_problem.h"
#include "tests/camera_drone.h"
#include "tests/obstacles.h"

namespace lapwing {

inline const Registry& plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

// {key = value, ...}
inline Value map_of(std::vector<std::pair<std::string, Value>> entries) {
  Value map = Value::map();
  for (auto& [key, value] : entries) map.set(key, std::move(value));
  return map;
}

inline Value list_of(const std::vector<double>& numbers) {
  Value list = Value::list();
  for (const double number : numbers) list.push_back(number);
  return list;
}

struct Moment {
  double time;
  std::vector<double> value;
  double weight = -1;  // none
};
inline Value moments(const std::vector<Moment>& all) {
  Value list = Value::list();
  for (const Moment& moment : all) {
    Value entry = map_of({{"time", moment.time}, {"value", list_of(moment.value)}});
    if (moment.weight >= 0) entry.set("weight", moment.weight);
    list.push_back(entry);
  }
  return list;
}

// The quadrotor in a problem that is not finished yet.
inline TrajectoryProblem flight(int stages, double step, const Vehicle& vehicle = camera_drone()) {
  TrajectoryProblem problem(vehicle, {.stages = stages, .step = step});
  problem.add_model("quadrotor", plugins().create<VehicleModel>("quadrotor"));
  return problem;
}

inline int offset_of(const TrajectoryProblem& problem, const char* block) {
  return problem.layout().offset(problem.layout().index(block));
}

inline std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no input error";
}

inline void expect_message(const std::function<void()>& call,
                           const std::vector<std::string>& parts) {
  const std::string message = message_of(call);
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos)
        << "'" << message << "' lacks '" << part << "'";
}

// A constraint bound to the drone's blocks alone: its bounds as they stand.
struct BoundConstraint {
  std::unique_ptr<Constraint> constraint;
  FunctionShape shape;
  std::vector<double> lower, upper;  // of the first instance
  StageLayout layout;
  Horizon horizon{.stages = 6, .step = 0.1};

  BoundConstraint(const char* name, const Value& parameters, const Vehicle& vehicle)
      : constraint(plugins().create<Constraint>(name, parameters)) {
    const auto model = plugins().create<VehicleModel>("quadrotor");
    model->bind(vehicle);
    for (const BlockSpec& block : model->blocks()) layout.add(block);
    const Environment environment;
    shape = constraint->bind({layout, horizon, vehicle, environment});
    lower.resize(shape.rows);
    upper.resize(shape.rows);
    constraint->bounds({0, 1}, lower.data(), upper.data());
  }

  // Whether one instance's inputs keep within the bounds.
  bool allows(const std::vector<double>& inputs) const {
    std::vector<double> values(shape.rows);
    Workspace workspace;
    constraint->evaluate({0, 1}, inputs.data(), values.data(), nullptr, workspace);
    for (int r = 0; r < shape.rows; ++r)
      if (values[r] < lower[r] || values[r] > upper[r]) return false;
    return true;
  }
};

}  // namespace lapwing
