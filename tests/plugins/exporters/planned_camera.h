// SPDX-License-Identifier: Apache-2.0
// A curved flight of a camera whose pose is known in closed form, for tests of exporters.
#pragma once

#include <cmath>

#include "framework/export/exporter.h"
#include "framework/plugin/registry.h"
#include "framework/vehicle/vehicle.h"
#include "tests/camera_drone.h"

namespace lapwing {

inline std::unique_ptr<Exporter> exporter_named(const std::string& name,
                                                const Value& parameters = {}) {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry.create<Exporter>(name, parameters);
}

inline Value with_frame_rate(double rate) {
  Value given = Value::map();
  given.set("frame_rate", rate);
  return given;
}

inline Vehicle filming_drone() {
  Vehicle vehicle = camera_drone();
  vehicle.gimbal = GimbalLimits{-2, 2, -1.5, 0.5, 2, 2};
  vehicle.camera = {"camera", 640, 480, 500, 500, 319.5, 239.5};
  return vehicle;
}

// A film of 2.03 s in steps of 0.1 s and less: rising circles around the origin, several turns of
// the heading, a camera that looks down more and more.
inline Plan planned_camera() {
  Plan plan;
  plan.mission = "A & B <\"Übersicht\">";
  plan.kind = "film";
  plan.vehicle = to_value(filming_drone());
  plan.trajectory.has_gimbal = true;
  for (int i = 0; i <= 21; ++i) {
    const double t = std::min(0.1 * i, 2.03);
    Sample s;
    s.time = t;
    s.position = {10 * std::cos(t), 10 * std::sin(t), 3 + t};
    s.velocity = {-10 * std::sin(t), 10 * std::cos(t), 1};
    s.acceleration = {-10 * std::cos(t), -10 * std::sin(t), 0};
    s.yaw = 3 * t + 1;
    s.yaw_rate = 3;
    s.gimbal_yaw = 0.2;
    s.gimbal_pitch = -0.3 * t;
    s.gimbal_pitch_rate = -0.3;
    plan.trajectory.samples.push_back(s);
  }
  return plan;
}

inline bool says(const std::vector<std::string>& sentences, const std::string& part) {
  for (const std::string& sentence : sentences)
    if (sentence.find(part) != std::string::npos) return true;
  return false;
}

}  // namespace lapwing
