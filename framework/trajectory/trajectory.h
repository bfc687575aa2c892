// SPDX-License-Identifier: Apache-2.0
// A time-sampled trajectory: what every planner produces and every exporter and verifier reads.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "framework/trajectory/motion_record.h"
#include "framework/trajectory/sample_columns.h"

namespace lapwing {

// World frame W: x east, y north, z up. Yaw about z, 0 along +x, counter-clockwise, unwrapped.
struct Sample {
  double time = 0;                                         // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      // m, W
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // m/s, W
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2, W
  double yaw = 0;                                          // rad
  double yaw_rate = 0;                                     // rad/s
  double gimbal_yaw = 0, gimbal_pitch = 0;                 // rad; where has_gimbal
  double gimbal_yaw_rate = 0, gimbal_pitch_rate = 0;       // rad/s; where has_gimbal
  Eigen::Vector3d target = Eigen::Vector3d::Zero();        // m, W; where has_target
  SampleColumns columns;                                   // of the motion
};

struct Trajectory {
  MotionRecord motion = force_motion();
  bool inputs_held = true;  // held until the next sample, or linear between samples
  bool has_gimbal = false;
  bool has_target = false;
  std::vector<Sample> samples;  // at least one; first at 0, times strictly increasing

  double duration() const {
    return samples.empty() ? 0.0 : samples.back().time - samples.front().time;
  }
};

}  // namespace lapwing
