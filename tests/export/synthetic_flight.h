// SPDX-License-Identifier: Apache-2.0
// A made-up flight with known numbers: a climbing wave around a tower, exact derivatives.
#pragma once

#include <cmath>

#include "framework/core/units.h"
#include "framework/trajectory/plan.h"
#include "framework/verify/certificate.h"
#include "tests/obstacles.h"
#include "tests/vehicle/vehicle_fixture.h"

namespace lapwing {

// Position and its first two derivatives of a sum of sines in each direction.
inline Sample synthetic_sample(double time, double duration, double mass) {
  Sample s;
  s.time = time;
  const auto wave = [&](int axis, double offset, double size, double turns, double phase) {
    const double w = 2 * std::numbers::pi * turns / duration;
    s.position[axis] += offset + size * std::sin(w * time + phase);
    s.velocity[axis] += size * w * std::cos(w * time + phase);
    s.acceleration[axis] += -size * w * w * std::sin(w * time + phase);
  };
  const double turns = duration / 40;
  wave(0, 4, 16 + duration / 20, turns, -1.4);
  wave(0, 0, 2, 3 * turns, 0.3);
  wave(1, -2, 11 + duration / 20, turns, 0.4);
  wave(2, 9, 5, 1.3 * turns, -1.2);
  s.yaw = std::atan2(s.velocity.y(), s.velocity.x());
  const double across2 = s.velocity.head<2>().squaredNorm();
  s.yaw_rate =
      (s.velocity.x() * s.acceleration.y() - s.velocity.y() * s.acceleration.x()) / across2;
  s.columns.set("force",
                Eigen::Vector3d(mass * (s.acceleration + Eigen::Vector3d(0, 0, kGravity))));
  s.columns.set("yaw_torque", 0.02 * std::sin(time));
  s.gimbal_pitch = radians(-35 + 25 * std::sin(0.4 * time));
  s.gimbal_pitch_rate = radians(10 * std::cos(0.4 * time));
  return s;
}

inline Certificate synthetic_certificate(bool feasible) {
  const auto check = [](const char* name, CheckGroup group, double worst, double limit,
                        const char* unit, double at) {
    return Check{.name = name,
                 .group = group,
                 .worst = worst,
                 .limit = limit,
                 .unit = unit,
                 .at = at,
                 .pass = worst <= limit};
  };
  constexpr CheckGroup kSafety = CheckGroup::safety, kTask = CheckGroup::task;
  Certificate certificate;
  certificate.checks = {check("position_defect", kSafety, 2.1e-7, 1e-3, "m", 4.2),
                        check("thrust_maximum", kSafety, 19.4, 28.8, "N", 3.4),
                        check("speed_across", kSafety, feasible ? 6.12 : 10.9, 10, "m/s", 5.7),
                        check("acceleration_across", kSafety, 1.03, 4, "m/s^2", 6),
                        check("yaw_rate", kSafety, 0.5, 1.570796, "rad/s", 6),
                        check("closed_loop_tracking", kSafety, 0.4, 0.3, "m", 7),
                        check("keyframe_miss", kTask, 0.21, 0.5, "m", 8)};
  certificate.checks[5].required = false;
  certificate.checks.push_back(
      {.name = "clearance", .skipped = "the environment is empty", .pass = false});
  return certificate;
}

inline Value synthetic_solver() {
  Value history = Value::list(), terms;
  for (int i = 0; i < 9; ++i) {
    terms = Value::map();
    terms.set("keyframe", 900 * std::exp(-1.3 * i) + 1.2);
    terms.set("derivative position", 40 * std::exp(-0.3 * i) + 8.25);
    terms.set("input_effort", 0.5 + 0.05 * i);
    double cost = 0;
    for (const auto& [name, value] : terms.as_map()) cost += value.as_number();
    Value iteration;
    iteration.set("iteration", i);
    iteration.set("cost", cost);
    iteration.set("violation", std::pow(10.0, -i));
    iteration.set("step", i < 2 ? 0.5 : 1.0);
    iteration.set("terms", terms);
    history.push_back(std::move(iteration));
  }
  Value solver;
  solver.set("name", "iqp");
  solver.set("status", "optimal");
  solver.set("iterations", 9);
  solver.set("cost", history.as_list().back().at("cost"));
  solver.set("terms", terms);
  solver.set("history", std::move(history));
  return solver;
}

// A tower that stands and a boat that circles it, filmed in turn with a cut in between, and a zone
// to keep out of; the camera of the flight looks where it likes.
inline void add_film(Plan& plan) {
  const double end = plan.trajectory.duration();
  Subject boat{.name = "boat <&>", .times = {}, .positions = {}, .height = 3, .width = 2};
  for (int i = 0; i <= 8; ++i) {
    const double angle = 2 * std::numbers::pi * i / 8;
    boat.times.push_back(end * i / 8);
    boat.positions.emplace_back(12 * std::cos(angle), 12 * std::sin(angle), 1.5);
  }
  plan.environment.subjects = {{"tower", {0}, {{0.5, -1.5, 6}}, 12, 5}, boat};
  auto& obstacles = plan.environment.obstacles;
  obstacles.push_back(zone_at("harbour", {{-18, 6}, {-8, 6}, {-12, 16}}));
  obstacles.push_back(zone_at("cable", {{10, -14}, {20, -14}, {20, -12}, {10, -12}}, 4, 7));
  for (std::size_t k = obstacles.size() - 2; k < obstacles.size(); ++k) obstacles[k].opaque = false;
  plan.environment = with_shapes(plan.environment);
  plan.cuts = {{0.45 * end, 0.55 * end}};
  plan.task.framing = {{"tower", {0, 0.5 * end}}, {"boat <&>", {0.5 * end, end}}};
  // The camera turns to what it films, so that it can be seen.
  for (Sample& s : plan.trajectory.samples) {
    const Subject& subject = plan.environment.subjects[s.time < 0.5 * end ? 0 : 1];
    const Eigen::Vector3d d = subject.position(s.time) - s.position;
    s.gimbal_yaw = std::remainder(std::atan2(d.y(), d.x()) - s.yaw, 2 * std::numbers::pi);
    s.gimbal_pitch = std::atan2(d.z(), d.head<2>().norm()) + 0.1;
  }
}

// `samples` samples over `duration` seconds and a keyframe every `spacing` seconds, each 0.2 m
// beside the path.
inline Plan synthetic_flight(double duration, int samples, double spacing, bool feasible = true) {
  const Vehicle vehicle = read_vehicle(vehicle_file());
  Plan plan;
  plan.mission = "tower wave";
  plan.kind = "film";
  plan.vehicle = to_value(vehicle);
  plan.trajectory.has_gimbal = true;
  double before = 0;
  for (int i = 0; i < samples; ++i) {
    Sample s = synthetic_sample(duration * i / (samples - 1), duration, vehicle.mass);
    s.yaw +=
        i > 0 ? 2 * std::numbers::pi * std::round((before - s.yaw) / (2 * std::numbers::pi)) : 0;
    before = s.yaw;
    plan.trajectory.samples.push_back(s);
  }
  for (double t = 0; t <= duration; t += spacing) {
    const Sample s = synthetic_sample(t, duration, vehicle.mass);
    KeyframeTask keyframe;
    keyframe.time = t;
    keyframe.position = s.position + Eigen::Vector3d(0, 0, 0.2);
    if (t > 0) keyframe.yaw = s.yaw;
    plan.task.keyframes.push_back(keyframe);
  }
  plan.environment.obstacles = {sphere_at("tree", {14, 8, 3}, 3),
                                box_at("tower", {-2, -4, 0}, {3, 1, 12})};
  plan.environment = with_shapes(plan.environment);
  plan.solver = synthetic_solver();
  plan.certificate = synthetic_certificate(feasible).to_value();
  plan.configuration.set("duration", duration);
  plan.configuration.set("solver", "iqp");
  return plan;
}

}  // namespace lapwing
