// SPDX-License-Identifier: Apache-2.0
// A plan and its flight, ideal or simulated under control, as a recorder sees it.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "framework/core/random.h"
#include "framework/trajectory/interpolate.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/closed_loop.h"
#include "tests/camera_drone.h"

namespace lapwing {

inline constexpr double kWaveLatitude = 46.5191, kWaveLongitude = 6.5668, kWaveHeight = 395;

struct RecordedState {
  double time = 0;  // s of the plan
  Eigen::Vector3d position, velocity, acceleration;
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d body_rates = Eigen::Vector3d::Zero();
  double yaw = 0;
  Eigen::Vector2d camera = Eigen::Vector2d::Zero();  // yaw and pitch in the world
};

inline Vehicle wave_vehicle() {
  Vehicle vehicle = camera_drone();
  vehicle.drag = 0.3;
  vehicle.gimbal = GimbalLimits{-2, 2, -1.5, 0.5, 2, 2};
  vehicle.camera = {"camera", 640, 480, 500, 500, 319.5, 239.5};
  return vehicle;
}

inline Sample wave_sample(double t) {
  Sample s;
  s.time = t;
  const auto add = [&](int axis, double size, double w, double phase) {
    s.position[axis] += size * std::sin(w * t + phase);
    s.velocity[axis] += size * w * std::cos(w * t + phase);
    s.acceleration[axis] -= size * w * w * std::sin(w * t + phase);
  };
  s.position.z() = 8;
  add(0, 12, 0.21, 0.3);
  add(0, 1.5, 0.8, 0);
  add(1, 9, 0.16, 1.1);
  add(1, 1, 0.7, 2);
  add(2, 2, 0.3, 0);
  s.yaw = 0.8 * std::sin(0.2 * t) + 0.05 * t;
  s.yaw_rate = 0.16 * std::cos(0.2 * t) + 0.05;
  s.gimbal_yaw = 0.3 * std::sin(0.3 * t);
  s.gimbal_yaw_rate = 0.09 * std::cos(0.3 * t);
  s.gimbal_pitch = -0.5 + 0.2 * std::sin(0.25 * t);
  s.gimbal_pitch_rate = 0.05 * std::cos(0.25 * t);
  return s;
}

// A wave of some 40 s, of the motion `velocity`, with a subject in its middle.
inline Plan wave_plan(double duration = 40) {
  Plan plan;
  plan.mission = "wave";
  plan.kind = "film";
  plan.vehicle = to_value(wave_vehicle());
  plan.geodetic_origin =
      GeodeticOrigin{kWaveLatitude, kWaveLongitude, kWaveHeight, HeightOf::sea, 48};
  plan.trajectory.motion = {.name = "velocity",
                            .columns = {{"jerk", "m/s^3", 3, true}},
                            .tracked = Tracking::acceleration};
  plan.trajectory.has_gimbal = true;
  for (int i = 0; 0.05 * i <= duration + 1e-9; ++i)
    plan.trajectory.samples.push_back(wave_sample(0.05 * i));
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); ++i) {
    auto& samples = plan.trajectory.samples;
    const std::size_t j = std::min(i, samples.size() - 2);
    samples[i].columns.set(
        "jerk", Eigen::Vector3d((samples[j + 1].acceleration - samples[j].acceleration) / 0.05));
  }
  return plan;
}

// The plan itself, as if flown without any error, from before its start to after its end.
inline std::vector<RecordedState> ideal_flight(const Plan& plan, double rate = 50,
                                               double before = 5, double after = 5) {
  std::vector<RecordedState> states;
  const double last = plan.trajectory.samples.back().time;
  for (double t = -before; t <= last + after; t += 1 / rate) {
    const bool moves = t > -1e-6 && t < last + 1e-6;
    const Sample s = sample_at(plan.trajectory, std::clamp(t, 0.0, last));
    RecordedState state;
    state.time = t;
    state.position = s.position;
    state.velocity = moves ? s.velocity : Eigen::Vector3d(Eigen::Vector3d::Zero());
    state.acceleration = moves ? s.acceleration : Eigen::Vector3d(Eigen::Vector3d::Zero());
    state.yaw = s.yaw;
    state.orientation = Eigen::AngleAxisd(s.yaw, Eigen::Vector3d::UnitZ());
    state.camera = {s.yaw + s.gimbal_yaw, s.gimbal_pitch};
    states.push_back(state);
  }
  return states;
}

// The plan flown by the whole quadrotor under control.
inline std::vector<RecordedState> simulated_flight(const Plan& plan,
                                                   const FlightConditions& conditions) {
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  const FlownPath path = fly(plan.trajectory, vehicle, conditions);
  std::vector<RecordedState> states;
  for (const FlownSample& sample : path.samples) {
    const double time = std::min(sample.time, plan.trajectory.samples.back().time);
    const Sample planned = sample_at(plan.trajectory, time);
    RecordedState state;
    state.time = sample.time;
    state.position = sample.state.position;
    state.velocity = sample.state.velocity;
    state.acceleration.setZero();
    state.orientation = sample.state.orientation;
    state.body_rates = sample.state.body_rates;
    state.yaw = planned.yaw + sample.yaw_error;
    state.camera = {planned.yaw + planned.gimbal_yaw, planned.gimbal_pitch};
    states.push_back(state);
  }
  return states;
}

// What is put on a flight before it is written.
struct Recording {
  double clock = 0;                                  // s of the log at the plan's time 0
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // m, of the log from the world
  double noise = 0;                                  // m, standard deviation of each axis
  std::uint64_t seed = 1;
};

inline std::vector<RecordedState> recorded(std::vector<RecordedState> states, const Recording& r) {
  Random random(r.seed);
  const auto normal = [&] {
    const double u = std::max(1e-12, random.uniform()), v = random.uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  };
  for (RecordedState& state : states) {
    state.time += r.clock;
    state.position += r.offset;
    for (int axis = 0; axis < 3; ++axis) state.position[axis] += r.noise * normal();
  }
  return states;
}

}  // namespace lapwing
