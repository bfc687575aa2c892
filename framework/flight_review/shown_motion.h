// SPDX-License-Identifier: Apache-2.0
// The motion of a log at even times, from which the limits of its vehicle are read. Internal to
// this room.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "framework/flight_log/flight_log.h"

namespace lapwing {

struct ShownState {
  double time = 0;                                   // s of the log
  Eigen::Vector3d position, velocity, acceleration;  // m, m/s, m/s^2; x east, y north, z up
  std::optional<Eigen::Quaterniond> orientation;     // body to world
  std::optional<Eigen::Vector3d> specific_force;     // m/s^2, body
  std::optional<Eigen::Vector3d> body_rates;         // rad/s, body
  std::optional<double> yaw;                         // rad
  std::optional<Eigen::Vector2d> camera;             // rad, yaw and pitch in the world
  std::optional<double> throttle;                    // share
  bool airborne = false;                             // 0.5 m and more above the lowest place
};

struct ShownMotion {
  double step = 0.05;  // s
  std::vector<ShownState> states;
  std::string source;  // of the positions, in words

  double airborne_time() const;  // s
};

// Positions, smooth (smooth_path.h), and everything else at the same times. InputError for a log
// without positions, and for a flight of less than 5 s in the air.
ShownMotion shown_motion(const FlightLog& log);

}  // namespace lapwing
