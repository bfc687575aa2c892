// SPDX-License-Identifier: Apache-2.0
// Plans that are known to be good, made from the equations of motion by hand.
//
// PlanBuilder strings intervals of held or linear acceleration together and integrates them in
// closed form, so a plan that it makes moves exactly as its inputs say. reference_plan() is a
// flight over 8 s that touches every check that this version makes; tests break it in one place
// each.
#pragma once

#include <cmath>
#include <functional>

#include "framework/core/units.h"
#include "framework/geometry/camera_axes.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"
#include "tests/camera_drone.h"
#include "tests/obstacles.h"

namespace lapwing {

inline Vehicle reference_vehicle() {
  Vehicle v = camera_drone("reference");
  v.rotors.diagonal = false;
  v.yaw_rate_max = radians(90);
  v.gimbal = GimbalLimits{-1, 1, radians(-90), 0, radians(90), radians(90)};
  v.camera = {"action", 1920, 1080, 890, 890, 959.5, 539.5};
  return v;
}

// What drives the motion: accelerations and gimbal rates.
struct Drive {
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2
  double yaw_acceleration = 0;                             // rad/s^2
  double gimbal_yaw_rate = 0, gimbal_pitch_rate = 0;       // rad/s
};

class PlanBuilder {
 public:
  explicit PlanBuilder(bool held, Sample start = {}, Vehicle vehicle = reference_vehicle())
      : vehicle_(std::move(vehicle)), next_(std::move(start)) {
    plan_.mission = "reference";
    plan_.kind = "film";
    plan_.vehicle = to_value(vehicle_);
    plan_.trajectory.inputs_held = held;
  }

  // One interval of `h` seconds under a drive that goes from a to b; b is ignored where inputs are
  // held.
  PlanBuilder& add(double h, const Drive& a, const Drive& b = {}) {
    drive(next_, a);
    plan_.trajectory.samples.push_back(next_);
    const Drive& e = plan_.trajectory.inputs_held ? a : b;
    const auto second = [h](auto first, auto last) { return h * h * (2 * first + last) / 6; };
    const auto once = [h](auto first, auto last) { return h * (first + last) / 2; };
    next_.position += h * next_.velocity + h * h / 6 * (2 * a.acceleration + e.acceleration);
    next_.velocity += h / 2 * (a.acceleration + e.acceleration);
    next_.yaw += h * next_.yaw_rate + second(a.yaw_acceleration, e.yaw_acceleration);
    next_.yaw_rate += once(a.yaw_acceleration, e.yaw_acceleration);
    next_.gimbal_yaw += once(a.gimbal_yaw_rate, e.gimbal_yaw_rate);
    next_.gimbal_pitch += once(a.gimbal_pitch_rate, e.gimbal_pitch_rate);
    next_.time += h;
    return *this;
  }

  // Closes the plan with a last sample under `last`; at rest by default.
  Plan finish(const Drive& last = {}) {
    drive(next_, last);
    plan_.trajectory.samples.push_back(next_);
    return plan_;
  }

 private:
  void drive(Sample& sample, const Drive& d) const {
    sample.acceleration = d.acceleration;
    const Eigen::Vector3d force =
        vehicle_.mass * (d.acceleration + Eigen::Vector3d(0, 0, kGravity));
    sample.columns.set("force", force);
    sample.columns.set("yaw_torque", vehicle_.inertia.z() * d.yaw_acceleration);
    sample.gimbal_yaw_rate = d.gimbal_yaw_rate;
    sample.gimbal_pitch_rate = d.gimbal_pitch_rate;
  }

  Vehicle vehicle_;
  Plan plan_;
  Sample next_;
};

struct ReferenceOptions {
  bool held = true;
  double step = 0.1;  // s, divides 8 s
  double lift = 0.4;  // m/s^2, negative: the flight descends
};

// A walker who stays 10 m in front of the camera, without regard to the ground; the camera is on
// him but for a cut in the middle.
inline void add_film(Plan& plan) {
  Subject walker{.name = "walker", .times = {}, .positions = {}, .height = 1.8, .width = 0.6};
  const auto& samples = plan.trajectory.samples;
  for (std::size_t i = 0; i < samples.size(); i += std::max<std::size_t>(1, samples.size() / 16)) {
    const Sample& s = samples[i];
    const auto axes = camera_axes(s.yaw + s.gimbal_yaw, s.gimbal_pitch);
    walker.times.push_back(s.time);
    walker.positions.push_back(s.position + 10 * axes.forward);
  }
  plan.environment.subjects = {walker, {"castle", {0}, {{0, 100, 5}}, 10, 8}};
  plan.environment.obstacles.push_back(
      zone_at("yard", {{-30, 4}, {-20, 4}, {-20, 6}, {30, 6}, {30, 9}, {-30, 9}}));
  plan.environment.obstacles.push_back(
      zone_at("roofs", {{-30, -3}, {30, -3}, {30, 3}, {-30, 3}}, -5, 3));
  plan.cuts = {{3.5, 4.25}};
  plan.task.framing = {{"walker", {0, 5}}, {"walker", {5, 8}}};
}

// From rest to rest along +x and up (or down), turning, with the gimbal moving.
inline Plan reference_plan(const ReferenceOptions& options = {}) {
  const double duration = 8;
  const int count = static_cast<int>(std::lround(duration / options.step));
  const auto drive = [&](double t) {
    const double wave = std::sin(2 * std::numbers::pi * t / duration);
    return Drive{{1.5 * wave, 0, options.lift * wave}, 0.1 * wave, 0.03, -0.05};
  };
  Sample start;
  start.position = {-8, 0, 10};
  start.gimbal_pitch = -0.3;
  PlanBuilder builder(options.held, start);
  for (int i = 0; i < count; ++i) {
    const double t = i * options.step;
    builder.add(options.step, drive(options.held ? t + options.step / 2 : t),
                drive(t + options.step));
  }
  Plan plan = builder.finish({.gimbal_yaw_rate = 0.04, .gimbal_pitch_rate = -0.05});
  plan.trajectory.has_gimbal = true;
  const auto& samples = plan.trajectory.samples;
  const Sample& middle = samples[samples.size() / 2];
  plan.task.keyframes = {
      {.time = 0, .position = samples.front().position},
      {.time = middle.time, .position = middle.position},
      {.time = duration, .position = samples.back().position, .yaw = samples.back().yaw}};
  plan.environment.margin = 0.5;
  plan.environment.obstacles = {sphere_at("tree", middle.position + Eigen::Vector3d(0, 3, 0), 1.0),
                                box_at("house", {-20, -30, 0}, {20, -4, 30})};
  plan.budget = 60;
  add_film(plan);
  return plan;
}

}  // namespace lapwing
