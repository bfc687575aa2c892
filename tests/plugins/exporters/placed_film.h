// SPDX-License-Identifier: Apache-2.0
// A film with a place on the earth, and its files.
#pragma once

#include "framework/verify/certificate.h"
#include "tests/plugins/exporters/placed_plan.h"

namespace lapwing {

// A certified film of 40 s: a half circle around a statue, then away from it.
inline Plan film_plan() {
  Plan plan = placed_plan();
  plan.mission = "A & B";
  plan.certificate = Certificate{{{.name = "clearance", .worst = 1, .pass = true}}}.to_value();
  plan.trajectory.samples.clear();
  plan.environment.subjects.push_back({.name = "statue", .times = {0}, .positions = {{0, 0, 1}}});
  plan.task.framing.push_back({"statue", {0, 20}});
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.1 * i, a = std::min(t, 20.0) * M_PI / 20, away = std::max(0.0, t - 20);
    Sample s;
    s.time = t;
    s.position = {20 * std::cos(a), 20 * std::sin(a) - 1.5 * away, 10};
    s.velocity = t < 20 ? Eigen::Vector3d(-M_PI * std::sin(a), M_PI * std::cos(a), 0)
                        : Eigen::Vector3d(0, -1.5, 0);
    s.yaw = t <= 20 ? a + M_PI : 2 * M_PI - 0.05 * away;
    s.gimbal_pitch = t <= 20 ? std::atan2(-9.0, 20.0) : -0.2;
    plan.trajectory.samples.push_back(s);
  }
  return plan;
}

inline std::string file_of(const char* format, const Plan& plan,
                           const Value& given = Value::map()) {
  return exporter_named(format, given)->write(plan);
}

}  // namespace lapwing
