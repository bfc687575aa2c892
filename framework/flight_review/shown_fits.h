// SPDX-License-Identifier: Apache-2.0
// Fits to the motion of a log, with their uncertainty. Internal to this room.
#pragma once

#include <optional>

#include "framework/flight_review/shown_motion.h"

namespace lapwing {

struct FitResult {
  double value = 0, low = 0, high = 0;  // and the interval of 95 %
  double time = 0;                      // s of data behind it
  // By the accelerometer. Else by a smooth path, whose own error the interval does not hold.
  bool measured = true;
};

// 1/s: linear drag over mass. What the accelerometer, or the acceleration and gravity, shows across
// the thrust is -d/m (R^T (v - w)) and a bias; the wind w is taken as constant and fitted too.
struct DragFit {
  FitResult drag;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  // m/s
};
std::optional<DragFit> fit_drag(const ShownMotion& motion);

// The throttle that holds the vehicle where it hardly moves.
std::optional<FitResult> fit_hover(const ShownMotion& motion);

// m/s^2 of the full throttle and the exponent p: specific force along the thrust = c times
// throttle^p behind the lag of the rotors, less the drag along it, wind included. Nothing where the
// throttle varies too little to tell.
struct ThrustFit {
  FitResult full, exponent;
};
std::optional<ThrustFit> fit_thrust(const FlightLog& log, const ShownMotion& motion);

// s: time constant by which the specific force follows throttle^p, from the samples of the log
// themselves, beside a constant and the drag. Nothing where the throttle changes too little.
std::optional<FitResult> fit_lag(const FlightLog& log, const ShownMotion& motion, double exponent);

}  // namespace lapwing
